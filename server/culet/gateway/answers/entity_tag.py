"""Entity tags (RFC 9110, 8.8.3): what a cache names a picture by, so that one that it has is not rendered again."""

from __future__ import annotations

import hashlib
import re

from pydantic import BaseModel

from culet.version import __version__

_TAG = re.compile(r'(?:W/)?("[^"]*")')


def entity_tag(scene: BaseModel, asked: str) -> str:
    """Of a scene's picture as it is asked for, by this version of culet. Weak, since another processor may round
    otherwise."""
    described = f"{__version__} {asked} {scene.model_dump_json()}"
    return f'W/"{hashlib.sha256(described.encode()).hexdigest()[:32]}"'


def names(if_none_match: str | None, tag: str) -> bool:
    """Whether the header `If-None-Match` has the tag, compared weakly as RFC 9110, 13.1.2, asks for."""
    if if_none_match is None:
        return False
    return if_none_match.strip() == "*" or tag.removeprefix("W/") in _TAG.findall(if_none_match)
