#!/usr/bin/env bash
# Runs the tests of the VTK filters on another version of VTK than scripts/test-python.sh does, with the wheel that this has built:
# scripts/test-vtk.sh [VERSION [pytest's options]]. VERSION: standard 9.3.1. Needs xvfb-run where there is no display.
set -euo pipefail
cd "$(dirname "$0")/.."
version=${1:-9.3.1}
shift || true
venv=target/python/vtk-$version
[ -x "$venv/bin/python" ] || "${VOLTET_PYTHON:-python3}" -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check "vtk==$version" numpy pytest
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --force-reinstall target/python/wheels/*.whl
display=()
[ -n "${DISPLAY:-}" ] || display=(xvfb-run --auto-servernum --server-args="-screen 0 1280x1024x24 -noreset")
exec "${display[@]}" "$venv/bin/python" -m pytest --quiet "$@" python/tests/test_vtk.py python/tests/test_vtk_habits.py python/tests/test_pieces.py
