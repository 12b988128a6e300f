#!/usr/bin/env bash
# Sets this program's frames beside VTK's, in one run: makes a virtual environment with VTK (target/vtk) and runs lab/bench/beside_vtk.py
# with it: VOLTET_TEST_DATA=FOLDER lab/scripts/compare-vtk.sh [options of lab/bench/beside_vtk.py]
# The folder holds bluntfin.vtu; --scenes heatsink needs none. The program is built for release, or named by VOLTET.
set -euo pipefail
cd "$(dirname "$0")/../.."

venv=target/vtk
[ -x "$venv/bin/python" ] || "${VOLTET_PYTHON:-python3}" -m venv "$venv"
"$venv/bin/python" -c 'import vtk' 2>/dev/null || "$venv/bin/python" -m pip install --quiet --disable-pip-version-check vtk==9.7.2 numpy
if [ -z "${VOLTET:-}" ]; then
    cargo build --release --quiet
    VOLTET=target/release/voltet
fi
exec "$venv/bin/python" lab/bench/beside_vtk.py --voltet "$VOLTET" "$@"
