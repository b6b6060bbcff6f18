"""Requests and replies as the JSON of their messages."""

from __future__ import annotations

from pydantic import BaseModel, ValidationError

from culet.errors import CuletError, InputError
from culet.scene.refusal import scene_error
from culet_protocol import engine as protocol
from culet_protocol import frame
from culet_protocol.watch import watch_id


def read_request(text: bytes) -> protocol.Request:
    """The request, or InputError that names the first field that cannot be used."""
    try:
        return protocol.engine_request.validate_json(text)
    except ValidationError as error:
        found = scene_error(error)
        raise InputError(f"request: {found}", found.field) from error


def refusal(error: CuletError) -> protocol.Reply:
    """The reply that says why not."""
    return protocol.Reply(
        status=error.status, title=error.title, detail=str(error), field=getattr(error, "field", None)
    )


def encoded(message: BaseModel) -> bytes:
    """JSON."""
    return message.model_dump_json().encode()


def refusal_by_session(session: str) -> bytes:
    """What somebody is sent who waits for a session's frames by the session's own id."""
    why = f"frames come by the session's watch id, {watch_id(session)}, since protocol 2: use the client of this server"
    return frame.refusal(bytes.fromhex(session), why)
