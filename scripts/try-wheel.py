#!/usr/bin/env python3
"""Installs a wheel into an empty virtual environment, and uses it from another folder as a user does: python scripts/try-wheel.py FOLDER

FOLDER holds wheels, of which pip chooses the one for this Python. Without Rust, without files of the checkout: the program's commands, a
picture by Python, a pipeline that is saved and drawn by the program, the plug-in of ParaView. Prints what was done; fails where something
is missing.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CODE = """
import sys, sysconfig
import numpy as np, voltet
from pathlib import Path
import voltet.nodes, voltet.widgets

x, y, z = np.mgrid[-1:1:9j, -1:1:9j, -1:1:9j]
# The module needs no lock of the interpreter where there is none.
assert getattr(sys, "_is_gil_enabled", lambda: True)() == (not sysconfig.get_config_var("Py_GIL_DISABLED"))
pipeline = voltet.scene(x * x + y * y + z * z, cmap="inferno", size=(48, 36), engine="cpu")
picture = pipeline.render()
assert picture.shape == (36, 48, 4) and 0 < picture[18, 24, 3] < 1, picture[18, 24]
pipeline.save("ball.toml")
picture.save("here.exr")
folder = Path(voltet.__file__).parent
assert folder.is_relative_to(sys.prefix) and (folder / "py.typed").exists()
assert "smproxy" in (folder / "paraview_plugin/VoltetFilters.py").read_text()
print(voltet.__version__)
"""


def main() -> int:
    wheels = Path(sys.argv[1]).resolve()
    versions = {wheel.name.split("-")[1] for wheel in wheels.glob("voltet-*.whl")}
    if len(versions) != 1:
        found = f"wheels of the versions {', '.join(sorted(versions))}" if versions else "no wheels"
        print(f"try-wheel: {wheels} holds {found}; expected those of one version", file=sys.stderr)
        return 1
    (version,) = versions
    with tempfile.TemporaryDirectory() as folder:
        environment = Path(folder, "environment")
        subprocess.run([sys.executable, "-m", "venv", environment], check=True)
        programs = environment / ("Scripts" if os.name == "nt" else "bin")
        python = programs / "python"
        install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        # From the folder alone; then what it needs.
        subprocess.run([*install, "--no-index", "--no-deps", "--find-links", wheels, "voltet"], check=True)
        subprocess.run([*install, "voltet"], check=True)
        elsewhere = Path(folder, "elsewhere")
        elsewhere.mkdir()
        # No Rust, no checkout, no other Python package.
        clean = {"PATH": str(programs) + (os.pathsep + os.environ["PATH"] if os.name == "nt" else os.pathsep + "/usr/bin" + os.pathsep + "/bin")}
        for name in ("HOME", "SYSTEMROOT", "TEMP", "TMP", "XDG_RUNTIME_DIR", "VK_ICD_FILENAMES"):
            if name in os.environ:
                clean[name] = os.environ[name]

        def ran(*command: str | Path, code: int = 0) -> str:
            start = time.perf_counter()
            done = subprocess.run(command, cwd=elsewhere, env=clean, capture_output=True, text=True, timeout=600)
            words = " ".join(map(str, [Path(command[0]).name, *command[1:3]])).splitlines()[0]
            assert done.returncode == code, f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
            print(f"{words}: {time.perf_counter() - start:.2f} s")
            return done.stdout + done.stderr

        voltet = programs / "voltet"
        assert ran(voltet, "--version").strip() == f"voltet {version}"
        assert ran(python, "-c", CODE).strip() == version
        assert "in order" in ran(voltet, "check", "ball.toml")
        ran(voltet, "run", "ball.toml")
        assert (elsewhere / "ball.png").read_bytes().startswith(b"\x89PNG")
        ran(voltet, "diff", "ball.png", "here.exr", "--limit", "0.01")
        assert "tetrahedr" in ran(voltet, "info", "ball.grid.vtu")
        ran(voltet, "start", "ball.grid.vtu", "-o", "again.toml")
        ran(voltet, "run", "again.toml", "--size", "32x24")
        assert "_voltet" in ran(voltet, "completions", "bash")
        ran(voltet, "man", "pages")
        assert (elsewhere / "pages" / "voltet-run.1").exists()
        assert "unknown command" in ran(voltet, "rum", code=2)
        assert "no such file" in ran(voltet, "run", "missing.toml", code=2).lower()
    print("done")
    return 0


if __name__ == "__main__":
    sys.exit(main())
