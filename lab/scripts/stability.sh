#!/bin/sh
# Writes docs/stability.md: how stable the formulas are on this machine, and on the software Vulkan driver
# (scripts/install-software-vulkan.sh). Run from anywhere.
set -e
cd "$(dirname "$0")/../.."
page=docs/stability.md
cargo build --release
{
    cat <<'END'
# Stability

How far every formula of every engine is from exact values, category by category, where cells are hard to draw, and what
becomes of the formulas that papers print. Made by `lab/scripts/stability.sh`; `voltet stability` says the same on any machine, and
ends with exit code 1 where a bound is broken. The column of a device is that of the software Vulkan driver, a program on the
CPU; `--adapter` names another one.

The exact values were computed with 60 to 90 digits and are part of the source (`lab/judge/fixtures`). A value passes when
its error is at most bound × exact value + floor; the bound follows from the working precision ε and the condition number k of
the case: 8 ε (4 + k) in 64 bits, 16 ε (4 + k) in 32 bits and twice that on a device for a closed form, more where colours are
found by quadrature (`lab/judge/bounds.rs`).

"Not judged" are categories without a case that has a bound in that precision: where a widget is a millionth of the segment
wide ("narrow"), the rounding of the segment's ends to 32 bits decides about the result. The native engine gives such segments
to the 64-bit forms, the device engine refuses such scenes.

END
    target/release/voltet stability --markdown --adapter software
} > "$page.new"
mv "$page.new" "$page"
