#!/usr/bin/env python3
"""Times of the usual run and of the one that leaves nothing out, for every pipeline that ships and one that `voltet start` writes.

    python3 lab/bench/leave_out.py [--voltet PROGRAM] [--runs 9] [PIPELINE ...]

Each run is `voltet run --exhaustive`, which after a run to warm up draws both ways in turn, twice, and reports the faster of each. Printed
are the medians of the runs as a Markdown table; what a pipeline writes goes to a folder that is removed. The exit code is 1 where leaving
nothing out is faster by more than the medians scatter (the middle half of the ratios lies below 1).
"""

import argparse
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def measured(program, pipeline, runs):
    """Seconds of the usual run and of the other one, for each run."""
    report = pipeline.parent / "report.json"
    pairs = []
    for _ in range(runs):
        command = [program, "run", "--quiet", "--exhaustive", "--report", report, pipeline]
        subprocess.run(command, check=True)
        found = json.loads(report.read_text())["runs"][0]["exhaustive"]
        pairs.append((found["usual_seconds"], found["seconds"]))
    return pairs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--voltet", default=ROOT / "target/release/voltet", type=Path, help="the program [%(default)s]")
    parser.add_argument("--runs", default=9, type=int, help="runs of each pipeline [%(default)s]")
    parser.add_argument("pipelines", nargs="*", type=Path, help="those alone")
    wish = parser.parse_args()
    program = wish.voltet.resolve()
    print("| pipeline | usual, median ms | nothing left out, median ms | ratio, median | its middle half |")
    print("| --- | ---: | ---: | ---: | --- |")
    slower = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "pipelines").mkdir()
        (folder / "data").symlink_to(ROOT / "data")
        for pipeline in wish.pipelines or sorted((ROOT / "pipelines").glob("*.toml")):
            shutil.copy(pipeline, folder / "pipelines")
        if not wish.pipelines:
            started = folder / "pipelines/started.toml"
            subprocess.run([program, "start", ROOT / "data/heat_sink.vtu", "-o", started], check=True, capture_output=True)
        for pipeline in sorted((folder / "pipelines").glob("*.toml")):
            pairs = measured(program, pipeline, wish.runs)
            usual, other = (1e3 * statistics.median(seconds) for seconds in zip(*pairs))
            ratios = sorted(other / usual for usual, other in pairs)
            low, high = ratios[len(ratios) // 4], ratios[-1 - len(ratios) // 4]
            middle = statistics.median(ratios)
            print(f"| {pipeline.stem} | {usual:.1f} | {other:.1f} | {middle:.3f} | {low:.3f} to {high:.3f} |", flush=True)
            if high < 1.0:
                slower.append(pipeline.stem)
    if slower:
        sys.exit(f"leaving nothing out is faster: {', '.join(slower)}")


if __name__ == "__main__":
    main()
