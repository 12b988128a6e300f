#!/usr/bin/env bash
# The library without its default features depends on nothing of the command line, and on no crate that measures or judges.
set -euo pipefail
cd "$(dirname "$0")/.."
foreign=$(cargo tree --locked -p voltet --no-default-features -e normal --prefix none |
    grep -E '^(clap|ctrlc|indicatif|annotate-snippets|voltet-(editor|judge|plugins|study|testing)) ' || true)
if [ -n "$foreign" ]; then
    printf 'the library depends on crates of the command line:\n%s\n' "$foreign" >&2
    exit 1
fi
