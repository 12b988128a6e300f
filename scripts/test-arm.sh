#!/usr/bin/env bash
# Runs the tests of the vector lanes for 64-bit ARM (Linux), and checks that the engine compiles there, and for macOS on ARM where that
# target is there. `scripts/test-arm.sh all` also runs the slow ones (a quarter of an hour or more): every formula
# against its 64-bit truth, the native engine's parts, whole pictures, the exact values of segments, and all integrators.
#
# Elsewhere than on ARM needs: rustup target add aarch64-unknown-linux-gnu; gcc-aarch64-linux-gnu, libc6-dev-arm64-cross and
# qemu-user, as Debian calls them.
set -euo pipefail
cd "$(dirname "$0")/.."
target=aarch64-unknown-linux-gnu
if [ "$(uname -m)" != aarch64 ]; then
    export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
    export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu"
fi
tested() { cargo test --locked --target "$target" "$@"; }
if [ "${1:-}" = all ]; then
    tested -p voltet-simd -p voltet-cpu --lib --test lane_sets --test methods --test segments
else
    tested -p voltet-simd --lib -- --skip every_twin --skip colours_of_dense --skip it_sorts_any
    cargo check --locked --target "$target" -p voltet-cpu
fi
if rustup target list --installed 2>/dev/null | grep -q aarch64-apple-darwin; then
    cargo check --locked --target aarch64-apple-darwin -p voltet-cpu
fi
