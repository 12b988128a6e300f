"""The program `voltet`, as the wheel installs it."""

from __future__ import annotations

import os
import signal
import sys


def main() -> int:
    """Carries out the command line of this process: the exit code."""
    from ._native import main as run

    # The program's own ends take their place.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run([os.path.abspath(sys.argv[0]), *sys.argv[1:]])
