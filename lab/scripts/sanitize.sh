#!/usr/bin/env bash
# Runs the tests of the vector lanes and of the native engine, pictures among them, under the address sanitizer, which stops
# at reads and writes outside of what was allocated. Needs a nightly toolchain, Linux or macOS; builds apart in
# target/sanitize. Any arguments go to the tests.
set -euo pipefail
cd "$(dirname "$0")/../.."
host=$(rustc +nightly -vV | sed -n 's/^host: //p')
export RUSTFLAGS="-Zsanitizer=address"
export CARGO_TARGET_DIR=target/sanitize
# With --target the flags are for the tests alone, not for build scripts and macros.
sanitized() { cargo +nightly test --locked --target "$host" "$@"; }
sanitized -p voltet-simd -p voltet-cpu --lib -- "$@"
sanitized -p voltet --no-default-features --test validation -- "$@"
