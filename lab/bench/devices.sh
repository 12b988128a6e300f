#!/usr/bin/env bash
# Prints what a frame takes on this machine's graphics device, in under five minutes: blunt fin, post, and generated grids
# of 4 and 16 million cells, at 1024² and 2560 × 1440. Builds nothing.
#
#   VOLTET_TEST_DATA=FOLDER lab/bench/devices.sh [OPTIONS OF voltet time, such as --engine all or --adapter NAME]
#
# Needs the program `voltet` (on the path, or named by VOLTET). The folder holds bluntfin.vtu and post.vtu; without it
# the generated grids alone are measured.
set -euo pipefail
scenes=$(cd "$(dirname "$0")/scenes" && pwd)
voltet=${VOLTET:-voltet}
data=${VOLTET_TEST_DATA:-}
sizes=${SIZES:-1024x1024,2560x1440}

measure() { "$voltet" time --engine gpu --frames 21 --patience 1.5 --size "$sizes" "$@"; }

echo "$("$voltet" --version), $(date +%F), $(uname -sm)"
for name in bluntfin post; do
    if [ -f "$data/$name.vtu" ]; then
        measure "$scenes/$name.toml" --set grid.path="$data/$name.vtu" "${@}"
    else
        printf '\nskipped: %s.vtu (VOLTET_TEST_DATA names no folder that has it)\n' "$name"
    fi
done
# Six tetrahedra a hexahedron: 4,088,832 and 16,113,714.
for side in 88 139; do
    measure "$scenes/wavelet.toml" --set grid.resolution="[$side,$side,$side]" "${@}"
done
