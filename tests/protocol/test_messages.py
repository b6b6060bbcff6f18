"""Control events and notices, against golden JSON that the browser's tests read too."""

from __future__ import annotations

import json
from typing import Any, get_args

import pytest
from pydantic import ValidationError

from culet_protocol import SUBPROTOCOL, VERSION, close
from culet_protocol.fixtures import CONTROL_EVENTS, FIXTURES, NOTICES, REFUSED_CONTROL, REFUSED_NOTICES
from culet_protocol.messages import (
    Orbit,
    Question,
    Resize,
    SessionEvent,
    ViewerEvent,
    control_event,
    notice,
    session_event,
)

GOLDEN: dict[str, Any] = json.loads((FIXTURES / "messages.json").read_text())


@pytest.mark.parametrize("message", GOLDEN["control_events"], ids=lambda message: message["type"])
def test_a_golden_control_event_survives_the_way_there_and_back(message: dict[str, Any]) -> None:
    assert json.loads(control_event.dump_json(control_event.validate_python(message), exclude_none=True)) == message


@pytest.mark.parametrize("message", GOLDEN["notices"], ids=lambda message: message["type"])
def test_a_golden_notice_survives_the_way_there_and_back(message: dict[str, Any]) -> None:
    assert json.loads(notice.dump_json(notice.validate_python(message))) == message


def test_there_is_a_golden_message_of_every_type() -> None:
    types = {type(event) for event in CONTROL_EVENTS}
    assert types == {*get_args(SessionEvent), *get_args(Question), *get_args(ViewerEvent)}
    mapping = notice.json_schema()["discriminator"]["mapping"]
    assert [entry["type"] for entry in GOLDEN["notices"]] == [message.model_dump()["type"] for message in NOTICES]
    assert {entry["type"] for entry in GOLDEN["notices"]} == set(mapping)


@pytest.mark.parametrize("text", REFUSED_CONTROL.values(), ids=REFUSED_CONTROL.keys())
def test_a_bad_control_event_is_refused(text: str) -> None:
    with pytest.raises(ValidationError):
        control_event.validate_json(text)


@pytest.mark.parametrize("text", REFUSED_NOTICES.values(), ids=REFUSED_NOTICES.keys())
def test_a_bad_notice_is_refused(text: str) -> None:
    with pytest.raises(ValidationError):
        notice.validate_json(text)


def test_what_concerns_one_viewer_never_reaches_the_engine() -> None:
    assert isinstance(session_event.validate_python({"type": "orbit", "yaw": 1, "pitch": 0}), Orbit)
    with pytest.raises(ValidationError, match="does not match any of the expected tags"):
        session_event.validate_python(Resize(width=640, height=360).model_dump())


def test_the_target_is_the_camera_unless_said() -> None:
    assert control_event.validate_json('{"type": "orbit", "yaw": 0, "pitch": 0}') == Orbit(yaw=0, pitch=0)


def test_the_subprotocol_names_the_version() -> None:
    assert f"culet.v{VERSION}" == SUBPROTOCOL


def test_close_codes_are_registered_or_private() -> None:
    # RFC 6455 section 7.4.2: 1000-2999 are the protocol's, 4000-4999 private; 1005, 1006, 1015 are never sent.
    assert all(1000 <= code <= 1014 or 4000 <= code <= 4999 for code in close.CloseCode)
    assert not {1005, 1006, 1015} & set(close.CloseCode)
    assert set(close.CloseCode) >= close.FINAL
