"""Folders of sockets, and what becomes of those that killed servers leave."""

from __future__ import annotations

from pathlib import Path

from culet.service.socket_folder import LOCK, PREFIX, clear_abandoned, socket_folder


def test_a_folder_is_gone_at_its_end(tmp_path: Path) -> None:
    with socket_folder(tmp_path) as folder:
        (folder / "control").touch()
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_server_left_is_cleared_and_what_a_living_one_has_is_kept(tmp_path: Path) -> None:
    abandoned = tmp_path / f"{PREFIX}abandoned"
    abandoned.mkdir()
    (abandoned / LOCK).touch()  # the lock itself ends with its process
    (abandoned / "frames").touch()
    others = tmp_path / f"{PREFIX}without-a-lock"
    others.mkdir()
    with socket_folder(tmp_path) as living, socket_folder(tmp_path) as second:
        assert sorted(tmp_path.iterdir()) == sorted([others, living, second])
        clear_abandoned(tmp_path)
        assert sorted(tmp_path.iterdir()) == sorted([others, living, second])
