#!/usr/bin/env python3
"""Times of steady frames on the CPU by stage, and a record of them by commit, by `voltet time`.

    lab/bench/frames.py [--voltet PROGRAM] [--scenes heat_sink,bluntfin,post,1M] [--sizes 512x512,1024x1024] [--threads 0]
                        [--extinction 1,50,500] [--frames 15] [--record lab/bench/record.csv]

Prints the tables of `voltet time` for the pipelines in lab/bench/scenes, with every extinction times each factor, and with each number
of threads (0: all). 1M, 4M and 16M are generated grids of so many cells; bluntfin and post are taken where VOLTET_TEST_DATA names a folder
that has them. `--record` appends a line for each row and marks those that took longer than the last line of the same machine.
"""

import argparse
import csv
import datetime
import os
import platform
import re
import subprocess
import tomllib
from pathlib import Path

BENCH = Path(__file__).resolve().parent
# Hexahedra a side, of six tetrahedra each: 0.98, 4.1 and 16.1 million cells.
SIDES = {"1M": 55, "4M": 88, "16M": 139}
HEAD = ["commit", "date", "machine", "scene", "look", "extinction", "size", "order", "threads", "lanes"]
TIMES = ["cull_ms", "sort_ms", "project_ms", "composite_ms", "frame_ms", "segments"]
# Quiet machines repeat a median to 3 %.
LOSS = 1.05


def command(*words, **options):
    return subprocess.run(words, capture_output=True, text=True, check=True, **options).stdout


def here():
    """Commit, with `+` where files are changed, date and processor."""
    git = lambda *words: command("git", "-C", str(BENCH), *words).strip()
    changed = "+" if git("status", "--porcelain", "--untracked-files=no") else ""
    info = Path("/proc/cpuinfo")
    name = re.search(r"model name\s*: (.*)", info.read_text()) if info.exists() else None
    machine = name[1].replace(",", "") if name else platform.processor()
    return [git("rev-parse", "--short", "HEAD") + changed, datetime.date.today().isoformat(), machine]


def pipeline(scene):
    """Pipeline file of a scene and the options that choose its grid; None where the data are missing."""
    if scene in SIDES:
        return BENCH / "scenes" / "wavelet.toml", [f"grid.resolution=[{SIDES[scene]},{SIDES[scene]},{SIDES[scene]}]"]
    folders = [BENCH.parent.parent / "data", Path(os.environ.get("VOLTET_TEST_DATA", "."))]
    grid = next((path for path in (folder / f"{scene}.vtu" for folder in folders) if path.is_file()), None)
    return (BENCH / "scenes" / f"{scene}.toml", [f"grid.path={grid}"]) if grid else None


def rows(text):
    """Look, size, order and times of each row that `voltet time` prints."""
    for line in text.splitlines():
        cells = [cell.strip(" *") for cell in line.split("|")][1:-1]
        if len(cells) > 12 and re.match(r"\d", cells[4]):
            yield cells[0], cells[1], cells[3], [*cells[7:11], cells[4], cells[12]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for option, value in [("voltet", "voltet"), ("scenes", "heat_sink,bluntfin,post,1M"), ("sizes", "512x512,1024x1024"),
                          ("threads", "0"), ("extinction", "1,50,500"), ("frames", "15")]:
        parser.add_argument(f"--{option}", default=value)
    parser.add_argument("--record", type=Path)
    wish = parser.parse_args()
    former = list(csv.reader(wish.record.open())) if wish.record and wish.record.exists() else []
    new, machine = [], here()
    for scene in wish.scenes.split(","):
        if not (found := pipeline(scene)):
            print(f"\nskipped: {scene} (VOLTET_TEST_DATA names no folder that has it)")
            continue
        file, options = found
        nodes = tomllib.loads(file.read_text())["nodes"]
        units = {name: node["unit_distance"] for name, node in nodes.items() if "unit_distance" in node}
        for factor in wish.extinction.split(","):
            for threads in wish.threads.split(","):
                sets = options + [f"{name}.unit_distance={unit / float(factor)}" for name, unit in units.items()]
                words = [word for option in sets for word in ("--set", option)]
                text = command(wish.voltet, "time", "--engine", "cpu", "--size", wish.sizes, "--frames", wish.frames,
                               "--patience", "1", str(file), *words, env={**os.environ, "RAYON_NUM_THREADS": threads})
                print(f"\n{scene}, extinction × {factor}, {threads} threads\n{text}")
                lanes = os.environ.get("VOLTET_LANES", "")
                for look, size, order, times in rows(text):
                    new.append([*machine, scene, look, factor, size, order, threads, lanes, *times])
    if wish.record:
        with wish.record.open("a", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(new if former else [HEAD + TIMES, *new])
        frame = len(HEAD) + TIMES.index("frame_ms")
        for line in new:
            then = next((old for old in reversed(former) if old[2 : len(HEAD)] == line[2 : len(HEAD)]), None)
            if then and float(line[frame]) > LOSS * float(then[frame]):
                print(f"slower than at {then[0]}: {', '.join(line[3:8])}: {then[frame]} to {line[frame]} ms")


if __name__ == "__main__":
    main()
