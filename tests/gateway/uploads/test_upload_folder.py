"""Uploads on disk, for the next gateway."""

from __future__ import annotations

from pathlib import Path

import pytest

from culet.gateway.uploads.upload_folder import StoredUpload, UploadFolder

MESH = StoredUpload("a" * 32, "mesh", "obj", b"v 0 0 0\n")
SKY = StoredUpload("b" * 32, "sky", "exr", b"v/1\x01")


def stored(folder: Path) -> UploadFolder:
    """A folder with both."""
    made = UploadFolder(folder)
    for upload in (MESH, SKY):
        made.write(upload.id, upload.kind, upload.file_type, upload.data)
    return made


def test_the_next_gateway_reads_what_was_written_and_not_removed(tmp_path: Path) -> None:
    folder = stored(tmp_path / "uploads")
    assert set(UploadFolder(tmp_path / "uploads").read()) == {MESH, SKY}
    folder.remove(MESH.id)
    assert list(UploadFolder(tmp_path / "uploads").read()) == [SKY]


def test_files_of_others_in_the_folder_are_let_be(tmp_path: Path) -> None:
    others = ["notes.txt", "thesis", "holiday.in.jpg", "archive.tar.gz", ".profile"]
    for name in others:
        (tmp_path / name).write_text("mine")
    stored(tmp_path)
    assert set(UploadFolder(tmp_path).read()) == {MESH, SKY}
    assert [name for name in others if (tmp_path / name).read_text() != "mine"] == []


def test_half_of_an_upload_is_cleared_away_by_the_next_gateway(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        stored(tmp_path)
    assert len(list(tmp_path.iterdir())) == 1
    assert list(UploadFolder(tmp_path).read()) == []
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_told_and_no_error(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "uploads").write_text("not a folder")
    stored(tmp_path / "uploads")
    assert "an upload would be lost with this process" in caplog.text
    assert list(UploadFolder(tmp_path / "uploads").read()) == []
