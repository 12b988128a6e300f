"""The wheel in an empty environment, from another folder: `scripts/try-wheel.py`."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT


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
