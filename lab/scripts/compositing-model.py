#!/usr/bin/env python3
"""Weak scaling of compositing by many processes, on paper: seconds and bytes of three schedules in the alpha-beta model.

    lab/scripts/compositing-model.py                        the table of docs/src/how-to/large-grids.md
    lab/scripts/compositing-model.py --merge 40e-9          with another time to merge a stretch

A message of n bytes takes alpha + n * beta seconds, and each process sends and receives one at a time (Hockney 1994). Each of P processes
draws a block of P = p^3 of the same number of cells, so the grid grows with P and the picture stays. A block covers a share
`footprint` * P^(-2/3) of the picture, and a ray passes about P^(1/3) blocks. Blocks whose group is a block again leave one stretch
on a ray that passes the group, since stretches that meet are joined; of cells dealt out at random none are.

- direct send (Hsu 1993): each process owns N / P pixels, and receives all stretches of their rays.
- radix-k (Peterka et al. 2009): log_k P rounds; in each the k processes of a group divide their common region among themselves.
- tree: log_2 P rounds; one of two processes sends all that it has to the other.

All end with N pixels at the first process, which takes them one message after the other; of direct send and radix-k that is the same
last step. The lower limit is what any exact method must move, as a run's report has it: of each process but the first the colour and
opacity of each pixel that it touches.
"""

import argparse
import math

PROCESSES = [10**3, 10**4, 10**5]
PIXEL = 16  # bytes of a finished pixel
TABLE = 4  # bytes of a pixel in the table of first stretches
# Of 587,439 stretches of two blocks of 3 million tetrahedra, on one thread of a busy machine: an upper bound.
MERGE = 85e-9
FOOTPRINT = 0.5


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pixels", type=float, default=1920 * 1080, help="pixels of the picture")
    parser.add_argument("--alpha", type=float, default=2e-6, help="seconds a message takes beside its bytes")
    parser.add_argument("--beta", type=float, default=1 / 10e9, help="seconds a byte takes")
    parser.add_argument("--stretch", type=float, default=32, help="bytes of a stretch")
    parser.add_argument("--merge", type=float, default=MERGE, help="seconds to merge a stretch (measured: ray_stretches and the stage merge of a report)")
    parser.add_argument("--footprint", type=float, default=FOOTPRINT, help="share of the picture that the whole grid covers")
    parser.add_argument("--cells", type=float, default=1e6, help="cells of a process, for those dealt out at random")
    parser.add_argument("--radix", type=int, default=8, help="processes of a group, for radix-k")
    return parser.parse_args()


class Scene:
    """Stretches on the rays of a group of blocks, for compact blocks or for cells dealt out at random."""

    def __init__(self, options, processes, is_dealt):
        self.options, self.processes, self.is_dealt = options, processes, is_dealt
        # Cells along a ray of the whole grid: of six tetrahedra a cube, about three a cube on a ray.
        self.cells_on_ray = 3 * (options.cells * processes / 6) ** (1 / 3)

    def stretches(self, group):
        """Stretches that a group of processes holds together, of all pixels."""
        covered = self.options.footprint * self.options.pixels
        if self.is_dealt:
            # Neighbours along the ray are one stretch with the chance that both are of the group.
            share = group / self.processes
            return covered * self.cells_on_ray * share * (1 - share) + covered * share
        return covered * (group / self.processes) ** (2 / 3)

    def bytes(self, group, share=1.0):
        """Bytes of a share of the region that a group covers."""
        region = self.options.pixels if self.is_dealt else self.options.pixels * (group / self.processes) ** (2 / 3)
        return share * (self.stretches(group) * self.options.stretch + region * TABLE)


def last_step(options, processes):
    """Seconds in which the first process receives the finished pixels of the others."""
    return options.alpha * (processes - 1) + options.beta * options.pixels * PIXEL


def direct_send(options, scene):
    p = scene.processes
    own = scene.bytes(1)
    # A block covers P^(-1/3) of the rows, and with them as many of the processes; one of cells dealt out at random all.
    receivers = p - 1 if scene.is_dealt else min(p - 1, p ** (2 / 3))
    merged = scene.stretches(1)
    seconds = 2 * options.alpha * receivers + 2 * options.beta * own + options.merge * merged
    return seconds + last_step(options, p), own + options.pixels * PIXEL / p


def radix_k(options, scene):
    p, k = scene.processes, options.radix
    seconds, sent, group = 0.0, 0.0, 1
    while group < p:
        step = min(k, math.ceil(p / group))
        # Of its group's region each process has one share, and sends all but one of its parts on.
        moved = scene.bytes(group, share=(step - 1) / step / group)
        seconds += 2 * options.alpha * (step - 1) + 2 * options.beta * moved
        seconds += options.merge * scene.stretches(group) / group
        sent += moved
        group *= step
    return seconds + last_step(options, p), sent + options.pixels * PIXEL / p


def tree(options, scene):
    seconds, sent, group = 0.0, 0.0, 1
    while group < scene.processes:
        moved = scene.bytes(group)
        seconds += options.alpha + options.beta * moved + 2 * options.merge * scene.stretches(group)
        # Half of the processes send in a round.
        sent += moved / (2 * group)
        group *= 2
    return seconds, sent


def lower_limit(options, scene):
    touched = min(scene.stretches(1), options.footprint * options.pixels)
    return touched * PIXEL * (scene.processes - 1) / scene.processes


def main():
    options = arguments()
    print("| partition | processes | stretches a ray | lower limit | direct send | radix-{} | tree |".format(options.radix))
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, is_dealt in [("blocks", False), ("at random", True)]:
        for processes in PROCESSES:
            scene = Scene(options, processes, is_dealt)
            a_ray = processes * scene.stretches(1) / (options.footprint * options.pixels)
            limit = lower_limit(options, scene)
            cells = [name, f"{processes:,}", f"{a_ray:,.0f}", size(limit)]
            for method in [direct_send, radix_k, tree]:
                seconds, sent = method(options, scene)
                cells.append(f"{seconds:.3g} s, {size(sent)}")
            print("| " + " | ".join(cells) + " |")


def size(count):
    for unit in ["B", "kB", "MB", "GB"]:
        if count < 1000 or unit == "GB":
            return f"{count:.3g} {unit}"
        count /= 1000


if __name__ == "__main__":
    main()
