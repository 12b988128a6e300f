#!/usr/bin/env bash
# Runs the test program with threads of the C interface under the thread sanitizer, which stops at two threads that touch the same
# memory, one of them writing, without an order between them. The standard library is built with it, too, and so are the program's
# own threads. Linux; needs a nightly toolchain with rust-src, and clang++. Builds apart in target/races.
set -euo pipefail
cd "$(dirname "$0")/.."
host=$(rustc +nightly -vV | sed -n 's/^host: //p')
export CARGO_TARGET_DIR=target/races
RUSTFLAGS="-Zsanitizer=thread" \
    cargo +nightly build --locked -Zbuild-std --target "$host" -p voltet-c --no-default-features "$@"
runtime=$(echo "$(rustc +nightly --print sysroot)/lib/rustlib/$host/lib"/*_rt.tsan.a)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
clang++ -std=c++17 -O1 -g -fsanitize=thread -Iinclude -c crates/capi/tests/c/threads.cpp -o "$folder/threads.o"
# The sanitizer's run-time library of the same compiler as the library; that of clang++ is another version.
clang++ "$folder/threads.o" "$CARGO_TARGET_DIR/$host/debug/libvoltet_c.a" \
    -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive -Wl,--export-dynamic -lpthread -ldl -lrt -lm -o "$folder/threads"
TSAN_OPTIONS="halt_on_error=1 second_deadlock_stack=1" "$folder/threads"
