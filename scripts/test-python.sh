#!/usr/bin/env bash
# Builds the Python module, installs it into a virtual environment of its own (target/python/venv) with what its tests need, and
# runs them: scripts/test-python.sh [pytest's options]
# Without Python 3.11 or packages from a registry it says that it was skipped; with VOLTET_REQUIRE_PYTHON=1 it fails then.
set -euo pipefail
cd "$(dirname "$0")/.."

skip() {
    echo "SKIPPED: the tests of the Python module: $*"
    [ -z "${VOLTET_REQUIRE_PYTHON:-}" ] || exit 1
    exit 0
}

python=${VOLTET_PYTHON:-python3}
"$python" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null ||
    skip "'$python' is no Python 3.11 or later with venv (VOLTET_PYTHON names another)"
folder=target/python
venv=$folder/venv
mkdir -p "$folder"
[ -x "$venv/bin/python" ] || "$python" -m venv "$venv"
if ! cmp -s python/tests/requirements.txt "$venv/requirements.txt"; then
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r python/tests/requirements.txt ||
        skip "their packages cannot be installed"
    cp python/tests/requirements.txt "$venv/requirements.txt"
fi

# The profile that the other tests are built with; without line tables a wheel is a tenth of the size.
rm -rf "$folder/wheels"
"$venv/bin/maturin" build --quiet --strip --profile dev --manifest-path python/Cargo.toml --out "$folder/wheels" \
    --interpreter "$venv/bin/python"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --force-reinstall "$folder"/wheels/*.whl

# The plug-in runs in ParaView, where Debian or Ubuntu have it.
if ! command -v pvpython >/dev/null || ! command -v xvfb-run >/dev/null; then
    scripts/install-paraview.sh >/dev/null 2>&1 || echo "ParaView cannot be installed here: the plug-in's tests will say that they were skipped"
fi

# What is saved from Python runs in the program, where one is built.
program=${VOLTET_PROGRAM:-target/debug/voltet}
if [ -x "$program" ]; then
    VOLTET_PROGRAM=$(realpath "$program")
    export VOLTET_PROGRAM
fi
# Pictures in windows that nobody sees.
export PYVISTA_OFF_SCREEN=true
exec "$venv/bin/python" -m pytest --quiet "$@" python/tests
