"""The notebooks are the tutorials, and they run."""

import os
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell
from tools.notebooks import TUTORIALS, notebook, path_of


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_notebook_is_its_tutorial(page):
    kept = path_of(page)
    assert kept.stat().st_size < 200_000
    assert nbformat.read(kept, as_version=4) == notebook(page), "make it again: python tests/tools/notebooks.py"


@pytest.mark.long
# nbclient and its parts warn of their own futures.
@pytest.mark.filterwarnings("default")
def test_a_notebook_runs_from_top_to_bottom(tmp_path, monkeypatch):
    """One with pictures, and a command of another. What else is in them, blocks of tutorials, runs as pages."""
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    ran = notebook(TUTORIALS[0])
    command = next(cell for cell in notebook(TUTORIALS[1]).cells if cell.source.startswith("!nearflat run"))
    ran.cells += [new_code_cell(f"{command.source} --no-figures")]
    NotebookClient(ran, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in ran.cells for output in cell.get("outputs", ()) if "data" in output]
    assert any("image/png" in output["data"] for output in shown), (os.environ.get("MPLBACKEND"), shown)
    assert "wrong way: 0" in "".join(output.get("text", "") for output in ran.cells[-1].outputs)
