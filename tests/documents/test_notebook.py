"""The notebook of the tutorial runs, and shows what it says."""

from __future__ import annotations

import base64
import io

import nbformat
import pytest
from nbclient import NotebookClient
from PIL import Image

from documents.pages import ROOT
from shared.patience import PATIENCE

NOTEBOOK = ROOT / "docs" / "tutorial" / "notebook.ipynb"


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of jupyter_client's
def test_the_notebook_runs_and_shows_pictures_and_a_frame() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    NotebookClient(notebook, timeout=int(PATIENCE), kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    shown = [output.data for output in outputs if "data" in output]
    pictures = [Image.open(io.BytesIO(base64.b64decode(data["image/png"]))) for data in shown if "image/png" in data]
    assert [picture.size for picture in pictures] == [(320, 240), (320, 200), (320, 200)]
    (frame,) = (data["text/html"] for data in shown if "text/html" in data and "<iframe" in data["text/html"])
    assert 'src="http://127.0.0.1:' in frame


def test_the_notebook_is_kept_without_what_it_shows() -> None:
    """Pictures would grow the repository with each change of a cell."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    assert [cell.outputs for cell in notebook.cells if cell.cell_type == "code" and cell.outputs] == []
