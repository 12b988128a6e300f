"""The wheel in an empty environment, from another folder: `scripts/try-wheel.py`."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import voltet


def test_the_wheel_works_in_an_empty_environment():
    folder = ROOT / "target/python/wheels"
    if len(list(folder.glob("*.whl"))) != 1:
        pytest.skip("scripts/test-python.sh builds the wheel")
    done = subprocess.run([sys.executable, ROOT / "scripts/try-wheel.py", folder], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.endswith("done\n"), done.stdout + done.stderr


def test_the_program_of_the_wheel_is_that_of_the_module():
    from importlib.metadata import entry_points, version

    (command,) = entry_points(group="console_scripts", name="voltet")
    assert command.value == "voltet._command:main" and callable(command.load())
    code = "import sys; sys.argv = ['voltet', '--version']; from voltet._command import main; sys.exit(main())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == f"voltet {version('voltet')}\n"


@pytest.mark.skipif(sys.platform != "linux", reason="a limit of addresses that the system keeps")
def test_the_program_of_the_wheel_ends_with_one_line_where_memory_does(tmp_path):
    pipeline = voltet.Pipeline()
    # 100 million cells.
    pipeline.add("grid", "wavelet", resolution=[256, 256, 256])
    widget = voltet.widgets.uniform(color=[1, 1, 1], extinction=1.0, region={"s": [-1000.0, 1000.0]})
    pipeline.add("look", "transfer-function", widgets=[widget])
    pipeline.add("view", "camera", eye=[-50, 0, 0], target=[0, 0, 0], size=[8, 8])
    pipeline.add("picture", "renderer", volume="grid", transfer_function="look", camera="view", engine="cpu")
    pipeline.save(tmp_path / "wavelet.toml")
    program = Path(sys.executable).with_name("voltet")
    line = f"ulimit -v {2 << 20} && exec '{program}' run wavelet.toml"
    few = os.environ | {"RAYON_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(["sh", "-c", line], cwd=tmp_path, env=few, capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.startswith("error: memory ends: found no room for "), done.stderr
    assert done.stderr.count("error:") == 1 and not (tmp_path / "wavelet.png").exists()


def test_a_plug_in_in_a_process_of_its_own_is_started_by_the_program_of_the_wheel(tmp_path):
    if not shutil.which("cc"):
        pytest.skip("there is no compiler of C")
    library, picture = tmp_path / "filter.so", tmp_path / "picture.png"
    source = ROOT / "examples/plugin_c/least_squares.c"
    subprocess.run(["cc", "-shared", "-fPIC", f"-I{ROOT / 'include'}", "-o", library, source, "-lm"], check=True)
    program = Path(sys.executable).with_name("voltet")
    words = ["--plugin", library, "--plugin-process", "--set", "gradient.method=c-least-squares", "--size", "32x24", "--output", picture]
    done = subprocess.run([program, "run", ROOT / "pipelines/quickstart.toml", *words], capture_output=True, text=True)
    assert done.returncode == 0 and picture.exists(), done.stderr
