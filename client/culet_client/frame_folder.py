"""Frames as files in a folder, and an index of what their headers said."""

from __future__ import annotations

import json
import math
import os
from dataclasses import fields
from pathlib import Path
from typing import Any

from culet_client.errors import ClientError
from culet_protocol.frame import Codec, Frame

EXTENSION = {Codec.JPEG: "jpg", Codec.PNG: "png"}
INDEX = "frames.jsonl"
"""One JSON object for each file: `file`, and the header's fields."""


class FrameFolder:
    """Writes `frame-000001.jpg` and so on; a file is there completely or not at all."""

    def __init__(self, folder: Path) -> None:
        """ClientError if the folder cannot be made."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ClientError(f"cannot make the folder {folder}: {error.strerror}") from error
        self.folder = folder
        self.count = 0

    def write(self, frame: Frame) -> Path:
        """Write the next file; ClientError if that is impossible."""
        if frame.codec not in EXTENSION:
            raise ClientError(f"frame {frame.sequence} is video, which makes no files of single pictures")
        self.count += 1
        path = self.folder / f"frame-{self.count:06}.{EXTENSION[frame.codec]}"
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            part.write_bytes(frame.payload)
            part.replace(path)
            with (self.folder / INDEX).open("a", encoding="utf-8") as index:
                index.write(json.dumps({"file": path.name} | header(frame)) + "\n")
        except OSError as error:
            part.unlink(missing_ok=True)
            raise ClientError(f"cannot write {path}: {error.strerror}") from error
        return path


def header(frame: Frame) -> dict[str, Any]:
    """The header's fields, as JSON's types; an error that is not known is null."""
    named = {field.name: getattr(frame, field.name) for field in fields(frame) if field.name != "payload"}
    error = None if math.isnan(frame.error) else frame.error
    return named | {
        "watch": frame.watch.hex(), "codec": frame.codec.name, "flags": int(frame.flags), "error": error,
    }  # fmt: skip
