"""What a journal keeps through interruptions, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from culet.errors import InputError
from culet.study.findings.journal import PointJournal
from culet.study.report import Point

IDENTITY: dict[str, object] = {"study": "rendering", "width": 320}


def point(key: str) -> Point:
    return Point(key=key, group="g", label=key, knobs={"n": 1, "on": True}, figures={"seconds": 0.1, "error": None})


def test_points_are_there_when_it_is_opened_again(tmp_path: Path) -> None:
    with PointJournal(tmp_path / "new" / "j", IDENTITY) as journal:
        journal.add(point("a"))
    with PointJournal(tmp_path / "new" / "j", IDENTITY) as journal:
        assert journal.points == {"a": point("a")}
        journal.add(point("b"))
    with PointJournal(tmp_path / "new" / "j", IDENTITY) as journal:
        assert list(journal.points) == ["a", "b"]


def test_a_line_that_was_cut_off_in_the_middle_is_measured_again(tmp_path: Path) -> None:
    path = tmp_path / "j"
    with PointJournal(path, IDENTITY) as journal:
        journal.add(point("a"))
        journal.add(point("b"))
    path.write_bytes(path.read_bytes()[:-20])
    with PointJournal(path, IDENTITY) as journal:
        assert list(journal.points) == ["a"]
        journal.add(point("b"))
    with PointJournal(path, IDENTITY) as journal:
        assert list(journal.points) == ["a", "b"]


def test_points_that_belong_together_are_kept_together_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "j"
    with PointJournal(path, IDENTITY) as journal:
        journal.add(point("a"))
        journal.add(point("b"), point("c"))
    whole = path.read_bytes()
    with PointJournal(path, IDENTITY) as journal:
        assert list(journal.points) == ["a", "b", "c"]
    path.write_bytes(whole[: whole.index(b'"c"')])
    with PointJournal(path, IDENTITY) as journal:
        assert list(journal.points) == ["a"]


def test_points_are_on_the_disk_before_the_journal_is_closed(tmp_path: Path) -> None:
    with PointJournal(tmp_path / "j", IDENTITY) as journal:
        journal.add(point("a"))
        assert (tmp_path / "j").read_text().count("\n") == 2


def test_a_journal_of_another_study_is_refused_and_named(tmp_path: Path) -> None:
    with PointJournal(tmp_path / "j", IDENTITY) as journal:
        journal.add(point("a"))
    with pytest.raises(InputError, match="width 320, now 640"):
        PointJournal(tmp_path / "j", {**IDENTITY, "width": 640})
    with PointJournal(tmp_path / "j", {**IDENTITY, "width": 640}, fresh=True) as journal:
        assert journal.points == {}


@pytest.mark.parametrize("content", ["not JSON\n", "[1]\n", '{"study": "rendering", "width": 320}\n{"key": 1}\n'])
def test_a_file_that_is_no_journal_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "j").write_text(content)
    with pytest.raises(InputError, match="--fresh"):
        PointJournal(tmp_path / "j", IDENTITY)
    assert (tmp_path / "j").read_text() == content
