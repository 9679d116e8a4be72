"""The notebook from a CAN log to a validated height runs, and its output agrees with its text."""

from __future__ import annotations

import nbformat
from nbclient import NotebookClient

from conftest import FIXTURES

ROOT = FIXTURES.parent


def test_the_notebook_runs_and_its_claims_hold():
    path = ROOT / "examples" / "validation.ipynb"
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    # Stored without output, so that the output is always that of this version.
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT)}}).execute()
    shown = [output for cell in code for output in cell.outputs]
    pictures = [output for output in shown if "image/png" in output.get("data", {})]
    assert len(pictures) == 5
    tables = [
        output["data"]["text/html"] for output in shown if "text/html" in output.get("data", {})
    ]
    assert any("95 % interval" in table for table in tables)
    text = "".join(output.get("text", "") for output in shown)
    assert "8 intervals hold the truth" in text
    # Text before every code cell explains its output.
    for before, cell in zip(notebook.cells, notebook.cells[1:], strict=False):
        if cell.cell_type == "code" and before.cell_type == "code":
            assert "select_order" in before.source
