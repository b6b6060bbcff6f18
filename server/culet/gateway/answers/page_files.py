"""The built page's files: compressed for whoever takes that, and kept by browsers if their names tell their content."""

from __future__ import annotations

import gzip
import os
from functools import lru_cache
from pathlib import Path

from starlette.datastructures import Headers
from starlette.responses import FileResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

HASHED = "/assets/"
"""Files below have a part of their content's hash in their names, and so never change."""
ELEMENT = "/element/"
"""The custom element for other sites' pages."""
SMALLEST = 1024
"""Bytes of a file that is compressed: a smaller one goes in one packet anyway."""
COMPRESSED = ("text/", "application/json", "image/svg+xml")
"""Media types that gzip makes smaller; scripts are `text/javascript`."""


class PageFiles(StaticFiles):
    """`index.html` for `/`, and what it loads."""

    def file_response(
        self, full_path: str | os.PathLike[str], stat_result: os.stat_result, scope: Scope, status_code: int = 200
    ) -> Response:
        """As of StaticFiles, with the headers that suit the file."""
        response = super().file_response(full_path, stat_result, scope, status_code)
        if isinstance(response, FileResponse) and _takes_gzip(scope):
            response = _compressed(response, Path(full_path), stat_result)
        response.headers.update(_manners(scope["path"]))
        return response


def _manners(path: str) -> dict[str, str]:
    """Headers of a file of that path."""
    if path.startswith(HASHED):
        return {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}
    manners = {"Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
    if path.startswith(ELEMENT):  # a script of other sites' pages, which is the same for everybody
        manners |= {"Access-Control-Allow-Origin": "*", "Cross-Origin-Resource-Policy": "cross-origin"}
    return manners


def _takes_gzip(scope: Scope) -> bool:
    headers = Headers(scope=scope)
    if scope["method"] != "GET" or "range" in headers:
        return False
    offers = [offer.split(";") for offer in headers.get("accept-encoding", "").lower().split(",")]
    return any(
        name.strip() == "gzip" and not any(part.strip().replace(" ", "") in _NOT_AT_ALL for part in parts)
        for name, *parts in offers
    )


_NOT_AT_ALL = ("q=0", "q=0.0", "q=0.00", "q=0.000")


def _compressed(response: FileResponse, file: Path, stat_result: os.stat_result) -> Response:
    kind = response.headers.get("content-type", "")
    if stat_result.st_size < SMALLEST or not kind.startswith(COMPRESSED):
        return response
    headers = {
        "Content-Encoding": "gzip",
        "Content-Type": kind,
        "ETag": f"W/{response.headers['etag']}",  # weak: the same content, other bytes
        "Last-Modified": response.headers["last-modified"],
    }
    return Response(_gzipped(file, stat_result.st_mtime_ns), response.status_code, headers)


@lru_cache(maxsize=64)
def _gzipped(file: Path, changed_ns: int) -> bytes:
    """The file as it was changed then."""
    del changed_ns
    return gzip.compress(file.read_bytes(), mtime=0)
