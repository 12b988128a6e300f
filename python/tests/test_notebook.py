"""The notebook runs from its first cell to its last, and its pictures are there."""

import pytest
from conftest import ROOT

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")


def test_the_notebook_runs(tmp_path):
    notebook = nbformat.read(ROOT / "examples/notebook/materials.ipynb", as_version=4)
    options = {"timeout": 300, "kernel_name": "python3", "resources": {"metadata": {"path": str(ROOT / "examples/notebook")}}}
    nbclient.NotebookClient(notebook, **options).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    printed = "".join(output.get("text", "") for output in outputs)
    difference = float(printed.split("ships:")[1].split()[0])
    assert difference < 1e-6 and "analytic" in printed
