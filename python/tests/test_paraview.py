"""The plug-in in ParaView, where there is one: `apt-get install paraview python3-paraview xvfb xauth`."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

import voltet

PLUGIN = Path(voltet.__file__).parent / "paraview_plugin/VoltetFilters.py"


def paraview(script, folder, *before, options=()):
    """Runs a script by pvpython, with the plug-in and a folder."""
    program = os.environ.get("VOLTET_PVPYTHON") or shutil.which("pvpython")
    if not program:
        pytest.skip("there is no pvpython: VOLTET_PVPYTHON names it")
    # The module alone: ParaView's Python has a numpy and a VTK of its own.
    modules = folder / "modules"
    modules.mkdir()
    (modules / "voltet").symlink_to(Path(voltet.__file__).parent)
    environment = {**os.environ, "PYTHONPATH": str(modules)}
    environment.pop("VIRTUAL_ENV", None)
    command = [*before, program, *options, ROOT / "python/tests" / script, PLUGIN, folder]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode == 0 and "done" in done.stdout, done.stdout + done.stderr


def test_the_plug_in_draws_and_a_state_is_saved_and_loaded(tmp_path):
    paraview("paraview_session.py", tmp_path, options=["--force-offscreen-rendering"])


def test_a_volume_stands_in_the_render_view(tmp_path):
    # Debian's ParaView draws with an X server alone.
    before = []
    if not os.environ.get("DISPLAY"):
        if not shutil.which("xvfb-run"):
            pytest.skip("there is no display, and no xvfb-run")
        # Without -noreset the server starts again when its last client leaves, and refuses who comes just then:
        # pvpython opens its display, closes it, and opens it again.
        before = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 1280x1024x24 -noreset"]
    paraview("paraview_view.py", tmp_path, *before)
