#!/usr/bin/env bash
# Builds the wheels that are published, and checks them: scripts/build-wheel.sh [FOLDER [PYTHON...]]
# FOLDER, standard dist, gets a wheel for each PYTHON. python3.11 makes the one for it and every later Python with the interpreter's lock;
# the stable interface of C has none without the lock before 3.15, so that python3.14t makes one for 3.14t alone, and python3.15t one for
# both kinds of 3.15 and later. Standard: all three on Linux, which needs none of them; elsewhere those that are there, and a line names the
# others. A PYTHON that is named must be there.
# On Linux zig links against the C library of manylinux 2.28, so that the wheels run on systems of 2018 and later; elsewhere it is the
# system's own. Needs Rust and Python 3.11 or later; its tools go to target/python/tools.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-dist}
shift || true
tools=target/python/tools
[ -x "$tools/bin/python" ] || "${VOLTET_PYTHON:-python3}" -m venv "$tools"
"$tools/bin/python" -m pip install --quiet --disable-pip-version-check 'maturin>=1.16,<2' ziglang twine auditwheel abi3audit
target=()
pythons=("$@")
if [ "$(uname -s)" = Linux ]; then
    target=(--target "$(uname -m)-unknown-linux-gnu" --zig --compatibility manylinux_2_28)
    [ $# -gt 0 ] || pythons=(python3.11 python3.14t python3.15t)
elif [ $# -eq 0 ]; then
    for python in python3.11 python3.14t python3.15t; do
        if command -v "$python" >/dev/null; then
            pythons+=("$python")
        else
            echo "build-wheel: no wheel by $python, which is not installed" >&2
        fi
    done
fi
if [ "${#pythons[@]}" -eq 0 ]; then
    echo "build-wheel: found none of python3.11, python3.14t and python3.15t" >&2
    exit 1
fi
built=$(mktemp -d)
trap 'rm -rf "$built"' EXIT
for python in "${pythons[@]}"; do
    PATH="$PWD/$tools/bin:$PATH" maturin build --locked --profile "${VOLTET_PROFILE:-release}" --strip --manifest-path python/Cargo.toml \
        --out "$built" --interpreter "$python" ${target[@]+"${target[@]}"}
    wheel=$(echo "$built"/voltet-*.whl)
    "$tools/bin/twine" check --strict "$wheel"
    # In one for 3.15 the audit takes the module's own entry point for a function of Python.
    case "$wheel" in *-cp311-abi3-*) "$tools/bin/abi3audit" --strict "$wheel" ;; esac
    [ "$(uname -s)" != Linux ] || "$tools/bin/auditwheel" show "$wheel"
    size=$(wc -c < "$wheel")
    echo "${wheel##*/}: $((size / 1000000)) MB"
    if [ "$size" -gt 25000000 ]; then
        echo "the wheel is larger than 25 MB" >&2
        exit 1
    fi
    mkdir -p "$folder"
    mv "$wheel" "$folder"
done
