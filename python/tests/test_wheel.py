"""The wheel in an empty environment, from another folder: `scripts/try-wheel.py`."""

import subprocess
import sys

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
