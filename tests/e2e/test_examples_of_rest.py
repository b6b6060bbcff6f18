"""The examples of REST in the documents, run as they stand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from documents.pages import blocks, run
from e2e.server import Server

THE_SERVER = re.compile(r"http://(?:127\.0\.0\.1|localhost):8000")


@pytest.mark.parametrize("document", ["README.md", "docs/how-to/rest.md", "docs/tutorial/first-stone.md"])
def test_the_examples_of_rest_run(server: Server, tmp_path: Path, document: str) -> None:
    """In their order, in one folder, since one may use what another made."""
    examples = [block for block in blocks(document, "sh") if "curl" in block]
    assert any("/api/render." in example for example in examples)
    # curl says nothing of an answer that is an error, unless told to.
    script = "\n".join(['curl() { command curl --fail "$@"; }', *examples])
    assert THE_SERVER.search(script)
    run(THE_SERVER.sub(server.url, script), tmp_path, "bash")
