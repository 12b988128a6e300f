#!/bin/sh
# Writes docs/src/explanation/stability.md: how stable the formulas are on this machine, and on the software Vulkan driver
# (scripts/install-software-vulkan.sh). Run from anywhere.
set -e
cd "$(dirname "$0")/../.."
page=docs/src/explanation/stability.md
cargo build --release
{
    cat <<'END'
# Stability

Errors of every formula of every engine against exact values, by category; then cells that are hard to draw, and the formulas as
papers print them. `lab/scripts/stability.sh` makes this page. `voltet stability` prints the same on any machine, with exit code 1 if a
bound is broken. The column of a device is that of a software Vulkan driver, which runs on the CPU; `--adapter` names another.

The exact values were computed with 60 to 90 digits and are part of the source (`lab/judge/fixtures`). A value passes if its error
is at most bound × exact value + floor. The bound follows from the working precision ε and the condition number k of the case:
8 ε (4 + k) in 64 bits, 16 ε (4 + k) in 32 bits and twice that on a device for a closed form, and more for colours by quadrature
(`lab/judge/bounds.rs`).

"Not judged" are categories without a case that has a bound in that precision: for a widget of a millionth of the segment
("narrow"), the rounding of the segment's ends to 32 bits decides the result. The CPU engine uses the 64-bit forms for such segments,
the device engine refuses such scenes.

END
    target/release/voltet stability --adapter software
} > "$page.new"
mv "$page.new" "$page"
