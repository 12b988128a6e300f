#!/usr/bin/env bash
# Runs the tests of the vector lanes and of the native engine for 64-bit ARM (Linux), whole pictures against the 64-bit referee
# among them, and checks that the engine compiles for macOS on ARM where that target is there.
#
# Elsewhere than on ARM needs: rustup target add aarch64-unknown-linux-gnu; gcc-aarch64-linux-gnu, libc6-dev-arm64-cross and
# qemu-user, as Debian calls them. An emulator is a hundred times slower than the machine: tests of what is the same
# everywhere are left out.
set -euo pipefail
cd "$(dirname "$0")/.."
target=aarch64-unknown-linux-gnu
if [ "$(uname -m)" != aarch64 ]; then
    export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
    export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu"
fi
tested() { cargo test --locked --target "$target" "$@"; }
tested -p voltet-lanes --lib
tested -p voltet-engine --lib --test lane_sets -- --skip every_number_of_segments
if rustup target list --installed 2>/dev/null | grep -q aarch64-apple-darwin; then
    cargo check --locked --target aarch64-apple-darwin -p voltet-engine
fi
