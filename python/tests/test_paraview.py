"""The plug-in in ParaView, where there is one: `apt-get install paraview python3-paraview`."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

import voltet


def test_the_plug_in_draws_and_a_state_is_saved_and_loaded(tmp_path):
    program = os.environ.get("VOLTET_PVPYTHON") or shutil.which("pvpython")
    if not program:
        pytest.skip("there is no pvpython: VOLTET_PVPYTHON names it")
    # The module alone: ParaView's Python has a numpy and a VTK of its own.
    modules = tmp_path / "modules"
    modules.mkdir()
    (modules / "voltet").symlink_to(Path(voltet.__file__).parent)
    environment = {**os.environ, "PYTHONPATH": str(modules)}
    environment.pop("VIRTUAL_ENV", None)
    script, plugin = ROOT / "python/tests/paraview_session.py", ROOT / "python/paraview/VoltetFilters.py"
    command = [program, "--force-offscreen-rendering", script, plugin, tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode == 0 and "done" in done.stdout, done.stdout + done.stderr
