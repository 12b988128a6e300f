#!/usr/bin/env bash
# Makes docs/src/explanation/study.md and its plots: three of the pipelines, small, every integrator and setting. Takes some minutes.
set -euo pipefail
cd "$(dirname "$0")/../.."

size="[320,240]"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
page="$folder/study.md"

cat > "$page" <<'TEXT'
# Error against time

Three of the pipelines, drawn with every integrator that supports them and its settings, on the CPU and on a graphics device if
there is one, against the 64-bit reference. `lab/scripts/study.sh` makes this page; `voltet study FILE` does the same for any scene, with
more figures.

`picture ms` is the median time of a picture from culling on, on the CPU with set-up (tables). Errors are those of premultiplied linear
RGBA over all pixels, 1 being full scale. `FLIP` is the perceptual difference of Andersson et al. (2020).
TEXT
printf '\nMeasured on %s with %s cores (%s).\n' "$(date +%F)" "$(nproc)" "$(uname -sm)" >> "$page"

cargo build --release --quiet
for name in quickstart_1d isotherms quickstart; do
    cargo run --release --quiet -- study "pipelines/$name.toml" --set view.size="$size" --frames 3 --patience 3 \
        --max-error 0.002 --output "$folder/$name" --cache "$folder/cache" > "$folder/$name.txt"
    cp "$folder/$name/plot.svg" "docs/src/explanation/study_$name.svg"
    {
        printf '\n## %s.toml at %s\n\n' "$name" "$size"
        printf '![Error against time of every integrator](study_%s.svg)\n\n```text\n' "$name"
        # All but the last line, which names a folder that is gone.
        sed '$d' "$folder/$name.txt"
        printf '```\n'
    } >> "$page"
done
cp "$page" docs/src/explanation/study.md
