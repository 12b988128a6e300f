#!/usr/bin/env bash
# Runs the portable lanes, the sorting network and the lists of the compositor in Miri, which stops at undefined behaviour.
# Needs a nightly toolchain: rustup component add --toolchain nightly miri rust-src. About a minute.
set -euo pipefail
cd "$(dirname "$0")/../.."
# Interpreted, the traces of the panics that a test asks for take longer than the tests.
export RUST_BACKTRACE=0
cargo +nightly miri test --locked -p voltet-simd --lib -- conformance sort
cargo +nightly miri test --locked -p voltet-cpu --lib -- lists
