#!/usr/bin/env bash
# Installs the library for C, C++ and Fortran: scripts/install-c.sh PREFIX [cargo's options, such as --no-default-features]
#   PREFIX/include/voltet.h, voltet.f90   PREFIX/lib/libvoltet.so, libvoltet.a   PREFIX/lib/pkgconfig/voltet.pc
# Linux. Without the feature gpu (--no-default-features) nothing of a graphics device is built.
set -euo pipefail
if [ $# -lt 1 ]; then sed -n '2,4s/^# //p' "$0"; exit 2; fi
mkdir -p "$1"
prefix=$(cd "$1" && pwd)
shift
cd "$(dirname "$0")/.."
# VOLTET_BUILT: a folder where both libraries are already.
built="${VOLTET_BUILT:-}"
if [ -z "$built" ]; then
    cargo build --locked --release -p voltet-c "$@"
    built="${CARGO_TARGET_DIR:-target}/release"
fi
mkdir -p "$prefix/include" "$prefix/lib/pkgconfig"
install -m 644 include/voltet.h include/voltet.f90 "$prefix/include/"
install -m 755 "$built/libvoltet_c.so" "$prefix/lib/libvoltet.so.0"
ln -sf libvoltet.so.0 "$prefix/lib/libvoltet.so"
install -m 644 "$built/libvoltet_c.a" "$prefix/lib/libvoltet.a"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
sed "s|@PREFIX@|$prefix|; s|@VERSION@|$version|" crates/capi/voltet.pc.in > "$prefix/lib/pkgconfig/voltet.pc"
echo "PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config --cflags --libs voltet"
