#!/usr/bin/env bash
# Draws the pictures of docs/src/gallery.md from pipelines/ and examples/python: scripts/gallery.sh [PROGRAM]. Without the path of a program it
# builds one. Those of Python need the environment that scripts/test-python.sh makes.
set -euo pipefail
cd "$(dirname "$0")/.."
program="${1:-}"
if [ -z "$program" ]; then
    cargo build --locked --release
    program="${CARGO_TARGET_DIR:-target}/release/voltet"
fi
# The page names each picture once.
grep -o 'images/gallery/[a-z_0-9]*\.jpg' docs/src/gallery.md | sort -u | while read -r image; do
    name=$(basename "$image" .jpg)
    if [ -f "examples/python/$name.py" ]; then
        PYVISTA_OFF_SCREEN=true target/python/venv/bin/python "examples/python/$name.py" "docs/src/$image"
        continue
    fi
    "$program" run "pipelines/$name.toml" --size 480x360 --set view.samples=9 --output "docs/src/$image"
done
