"""The notebooks run, and their output agrees with their text."""

from __future__ import annotations

import nbformat
from nbclient import NotebookClient

from conftest import FIXTURES, cg

ROOT = FIXTURES.parent


def shown(name: str) -> tuple[nbformat.NotebookNode, list[nbformat.NotebookNode]]:
    """Run a notebook and return it with its outputs."""
    notebook = nbformat.read(ROOT / "examples" / name, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    # Stored without output, so that the output is always that of this version.
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT)}}).execute()
    return notebook, [output for cell in code for output in cell.outputs]


def pictures(outputs: list[nbformat.NotebookNode]) -> int:
    return sum("image/png" in output.get("data", {}) for output in outputs)


def printed(outputs: list[nbformat.NotebookNode]) -> str:
    return "".join(output.get("text", "") for output in outputs)


def explained(notebook: nbformat.NotebookNode) -> bool:
    """Return whether there is text before every code cell, which explains its output."""
    pairs = zip(notebook.cells, notebook.cells[1:], strict=False)
    both = [(before, cell) for before, cell in pairs if cell.cell_type == "code"]
    return all(before.cell_type != "code" or "select_order" in before.source for before, _ in both)


def test_the_notebook_runs_and_its_claims_hold():
    notebook, outputs = shown("validation.ipynb")
    assert pictures(outputs) == 5
    tables = [
        output["data"]["text/html"] for output in outputs if "text/html" in output.get("data", {})
    ]
    assert any("95 % interval" in table for table in tables)
    assert "8 intervals hold the truth" in printed(outputs)
    assert explained(notebook)


def test_the_notebook_of_the_fmus_runs_and_finds_the_height(monkeypatch):
    monkeypatch.setenv("CG", cg())
    notebook, outputs = shown("fmu.ipynb")
    assert pictures(outputs) == 2
    assert "19 signals of the plant are inputs of the estimator" in printed(outputs)
    assert "the interval holds the truth" in printed(outputs)
    assert explained(notebook)
