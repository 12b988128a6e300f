#!/usr/bin/env bash
# Installs the implementation of Catalyst: scripts/install-catalyst.sh FOLDER [cargo's options, such as --features mpi]
#   FOLDER/libcatalyst-voltet.so
# Linux. FOLDER is what a simulation states below catalyst_load/search_paths, or the variable CATALYST_IMPLEMENTATION_PATHS.
set -euo pipefail
if [ $# -lt 1 ]; then sed -n '2,4s/^# //p' "$0"; exit 2; fi
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
cd "$(dirname "$0")/.."
cargo build --locked --release -p voltet-catalyst "$@"
install -m 755 "${CARGO_TARGET_DIR:-target}/release/libcatalyst_voltet.so" "$folder/libcatalyst-voltet.so"
echo "CATALYST_IMPLEMENTATION_NAME=voltet CATALYST_IMPLEMENTATION_PATHS=$folder"
