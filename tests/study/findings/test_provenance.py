"""What a figure's provenance, and a journal's identity, take into account."""

from __future__ import annotations

from pathlib import Path

import pytest

import culet
from culet.study.findings import provenance
from culet.study.findings.provenance import (
    REFERENCE_CODE,
    RENDERING_STUDY,
    SIMULATION_STUDY,
    STREAMING_STUDY,
    code_digest,
    peer_versions,
)

DECIDING = (
    (RENDERING_STUDY, "study/renderer/race.py"),
    (RENDERING_STUDY, "study/likeness/image_error.py"),
    (RENDERING_STUDY, "rendering/renderer.py"),
    (SIMULATION_STUDY, "study/motion/motions.py"),
    (SIMULATION_STUDY, "study/motion/tops.py"),
    (SIMULATION_STUDY, "simulation/one_stone/rigid.py"),
    (STREAMING_STUDY, "simulation/one_stone/simulation.py"),
    (STREAMING_STUDY, "study/stream/streaming.py"),
    (REFERENCE_CODE, "study/renderer/knobs.py"),
)


@pytest.mark.parametrize(("names", "module"), DECIDING)
def test_another_state_of_what_decides_the_points_has_another_digest(
    names: tuple[str, ...], module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = code_digest.__wrapped__(names)
    read, changed = Path.read_bytes, Path(culet.__file__).parent / module
    monkeypatch.setattr(Path, "read_bytes", lambda path: b"changed" if path == changed else read(path))
    assert code_digest.__wrapped__(names) != before


def test_a_reference_outlives_what_does_not_make_it(monkeypatch: pytest.MonkeyPatch) -> None:
    before = code_digest.__wrapped__(REFERENCE_CODE)
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: b"changed" if path.name == "page.py" else read(path))
    assert code_digest.__wrapped__(REFERENCE_CODE) == before


def test_versions_are_of_what_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "numpy " in peer_versions()
    monkeypatch.setattr(provenance, "PEERS", ("numpy", "no-such-package"))
    assert peer_versions().startswith("numpy ")
    assert "no-such-package" not in peer_versions()
