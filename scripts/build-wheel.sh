#!/usr/bin/env bash
# Builds the wheel that is published, for this and every later Python, and checks it: scripts/build-wheel.sh [FOLDER]
# FOLDER, standard dist, gets the wheel. On Linux zig links it against the C library of manylinux 2.28, so that it runs on systems of 2018
# and later; elsewhere it is the system's own. Needs Rust and Python 3.11 or later; its tools go to target/python/tools.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-dist}
tools=target/python/tools
[ -x "$tools/bin/python" ] || "${VOLTET_PYTHON:-python3}" -m venv "$tools"
"$tools/bin/python" -m pip install --quiet --disable-pip-version-check 'maturin>=1.9,<2' ziglang twine auditwheel abi3audit
target=()
if [ "$(uname -s)" = Linux ]; then
    target=(--target "$(uname -m)-unknown-linux-gnu" --zig --compatibility manylinux_2_28)
fi
PATH="$PWD/$tools/bin:$PATH" maturin build --locked --profile "${VOLTET_PROFILE:-release}" --strip --manifest-path python/Cargo.toml \
    --out "$folder" ${target[@]+"${target[@]}"}
wheel=$(ls -t "$folder"/voltet-*.whl | head -n 1)
"$tools/bin/twine" check --strict "$wheel"
"$tools/bin/abi3audit" --strict "$wheel"
[ "$(uname -s)" != Linux ] || "$tools/bin/auditwheel" show "$wheel"
size=$(wc -c < "$wheel")
echo "$wheel: $((size / 1000000)) MB"
if [ "$size" -gt 25000000 ]; then
    echo "the wheel is larger than 25 MB" >&2
    exit 1
fi
