"""What the images are built of is there, and what they install is named by its hashes."""

from __future__ import annotations

import re
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest
from packaging.requirements import Requirement

REPOSITORY = Path(__file__).parents[2]
DOCKER = REPOSITORY / "docker"


def locked(name: str) -> dict[str, tuple[str, list[str]]]:
    """Version and hashes, by the package's name."""
    text = (DOCKER / name).read_text().replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    found = {}
    for line in lines:
        pinned = re.match(r"([a-z0-9.-]+)==(\S+)", line)
        assert pinned, line
        found[pinned[1]] = pinned[2], re.findall(r"--hash=sha256:[0-9a-f]{64}", line)
    return found


def project() -> dict[str, list[str]]:
    """What the project needs, by the file that has it with all that this needs in turn."""
    described = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())
    always, extras = described["project"]["dependencies"], described["project"]["optional-dependencies"]
    return {
        "requirements.txt": always,
        "requirements-batch.txt": always + extras["batch"],
        "requirements-build.txt": described["build-system"]["requires"],
    }


@pytest.mark.parametrize("name", project())
def test_what_is_installed_has_hashes_and_is_what_the_project_asks_for(name: str) -> None:
    """`make lock` writes it anew."""
    found = locked(name)
    assert all(hashes for _, hashes in found.values())
    for text in project()[name]:
        asked = Requirement(text)
        version, _ = found[re.sub(r"[-_.]+", "-", asked.name).lower()]
        assert asked.specifier.contains(version), f"{text}: make lock"
    assert "://" not in (DOCKER / name).read_text(), "whoever builds an image has an index of their own"


def test_workers_have_the_versions_that_servers_have() -> None:
    servers, workers = locked("requirements.txt"), locked("requirements-batch.txt")
    assert servers.items() <= workers.items()


def test_all_that_an_image_copies_is_sent_to_its_builder() -> None:
    sent = [
        line.removeprefix("!") for line in (REPOSITORY / ".dockerignore").read_text().splitlines() if line[0] == "!"
    ]
    lines = [line for line in (DOCKER / "Dockerfile").read_text().splitlines() if line.startswith("COPY ")]
    copied = [source for line in lines if "--from" not in line for source in line.split()[1:-1]]
    assert "docker/haproxy.cfg" in copied
    for source in copied:
        assert list(REPOSITORY.glob(source)), source
        ways = [source, *map(str, Path(source).parents)]
        assert any(fnmatch(way, pattern) for pattern in sent for way in ways), source
