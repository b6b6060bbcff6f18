"""The README's REST examples, run as they stand."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

from e2e.conftest import REPOSITORY
from e2e.server import Server

README_SERVER = re.compile(r"http://(?:127\.0\.0\.1|localhost):8000")


def rest_examples() -> list[str]:
    """The `sh` blocks of the README's section whose heading names REST."""
    examples, in_section = [], False
    for part in re.split(r"(^```.*?^```$)", (REPOSITORY / "README.md").read_text(), flags=re.MULTILINE | re.DOTALL):
        if part.startswith("```"):
            if in_section and part.startswith("```sh\n"):
                examples.append(part.removeprefix("```sh\n").removesuffix("```"))
        elif headings := re.findall(r"^#+ (.*)$", part, flags=re.MULTILINE):
            in_section = "REST" in headings[-1]
    return examples


def test_the_readme_s_rest_examples_run(server: Server, tmp_path: Path) -> None:
    """In their order, in one folder, since one may use what another made."""
    examples = rest_examples()
    assert any("curl" in example for example in examples), "README.md has no sh block with curl under a REST heading"
    assert any("render.png" in example for example in examples)
    # curl says nothing of an answer that is an error, unless told to.
    script = "\n".join(["set -euo pipefail", 'curl() { command curl --fail "$@"; }', *examples])
    assert README_SERVER.search(script)
    bash = shutil.which("bash")
    assert bash
    ran = subprocess.run(
        [bash, "-c", README_SERVER.sub(server.url, script)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, f"{ran.stdout}\n{ran.stderr}"
