"""The description of the REST interface, with what pydantic leaves out of it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from fastapi import FastAPI


class Application(FastAPI):
    """FastAPI, whose document says of each of several forms that it needs the field that tells them apart.

    The models have a default for that field, so that code need not repeat it; JSON without it is refused.
    """

    _document: bytes | None = None

    def document(self) -> bytes:
        """The document as JSON; making it takes some 0.3 s, once."""
        if self._document is None:
            self._document = json.dumps(self.openapi()).encode()
        return self._document

    def openapi(self) -> dict[str, Any]:
        """The document, made once."""
        if self.openapi_schema is None:
            document = super().openapi()
            for discriminator in list(_discriminators(document)):
                for reference in discriminator["mapping"].values():
                    _require(
                        document["components"]["schemas"][reference.rpartition("/")[2]], discriminator["propertyName"]
                    )
        assert self.openapi_schema is not None  # noqa: S101 - set by FastAPI
        return self.openapi_schema


def _discriminators(part: object) -> Iterator[dict[str, Any]]:
    if isinstance(part, dict):
        if "mapping" in part.get("discriminator", ()):
            yield part["discriminator"]
        for inner in part.values():
            yield from _discriminators(inner)
    elif isinstance(part, list):
        for inner in part:
            yield from _discriminators(inner)


def _require(schema: dict[str, Any], name: str) -> None:
    schema["properties"][name].pop("default", None)
    required = schema.setdefault("required", [])
    if name not in required:
        required.append(name)
