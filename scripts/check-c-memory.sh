#!/usr/bin/env bash
# Runs the example in C and the test programs of the C interface under valgrind: reads and writes outside of what was allocated,
# values that were never set, leaks: scripts/check-c-memory.sh [LIBRARY]
# Needs a C and a C++ compiler, and valgrind. LIBRARY is a libvoltet_c.so that is built already; without it, it is built.
set -euo pipefail
library=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."
if [ -z "$library" ]; then
    cargo build --locked -p voltet-c
    library="${CARGO_TARGET_DIR:-target}/debug/libvoltet_c.so"
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$library" "$folder/libvoltet.so.0"
ln -s libvoltet.so.0 "$folder/libvoltet.so"
linked=(-g -Iinclude "-L$folder" -lvoltet -lm -lpthread "-Wl,-rpath,$folder")
cc -std=c99 -O1 examples/renderer_c/picture.c "${linked[@]}" -o "$folder/picture"
cc -std=c99 -O1 crates/capi/tests/c/wrong.c "${linked[@]}" -o "$folder/wrong"
c++ -std=c++17 -O1 crates/capi/tests/c/threads.cpp "${linked[@]}" -o "$folder/threads"
# valgrind does not know AVX-512.
if [ "$(uname -m)" = x86_64 ]; then
    export VOLTET_LANES=avx2
fi
# Without a device: valgrind would look into its driver.
# The second name is that of older loaders.
export VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent
# A shipped pipeline in the size of a thumbnail, as all takes fifty times as long here.
sed -e "s|\.\./data|$PWD/data|" -e 's/^size = .*/size = [200, 150]/' pipelines/quickstart_1d.toml > "$folder/small.toml"
checked() {
    valgrind --quiet --leak-check=full --show-leak-kinds=definite,indirect,possible --errors-for-leak-kinds=definite,indirect,possible \
        --suppressions=scripts/valgrind.supp --error-exitcode=1 "$@"
}
checked "$folder/picture" own "$folder/own.ppm"
checked "$folder/picture" file "$folder/small.toml" "$folder/file.ppm"
checked "$folder/wrong"
checked "$folder/threads"
