"""What is said of a place where nothing can listen: what was asked for, what is wrong with it, what to do."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
import zmq

from culet.endpoints import FORMS, bind, check_trusted
from culet.errors import InputError

ABSENT_ADDRESS = "203.0.113.9"
"""RFC 5737: for documentation, so that no machine has it."""


@pytest.fixture
def router() -> Iterator[zmq.Socket[bytes]]:
    """A socket that is not bound yet."""
    with zmq.Context() as context, context.socket(zmq.ROUTER) as one:
        yield one


def refusal(router: zmq.Socket[bytes], endpoint: str) -> str:
    """What is said of it, after the option and the endpoint."""
    with pytest.raises(InputError) as refused:
        bind(router, endpoint, "control")
    assert refused.value.field == "control"
    beginning, said = str(refused.value).split(f"{endpoint!r}: ")
    assert beginning == "--control: cannot listen at "
    return said


def test_a_missing_folder_is_named(router: zmq.Socket[bytes], tmp_path: Path) -> None:
    said = refusal(router, f"ipc://{tmp_path}/no/such/control")
    assert said == f"there is no folder {tmp_path}/no/such; make it, or choose another"


def test_a_file_is_not_overwritten(router: zmq.Socket[bytes], tmp_path: Path) -> None:
    file = tmp_path / "precious"
    file.write_text("kept")
    assert "is not a socket; choose another name" in refusal(router, f"ipc://{file}")
    assert file.read_text() == "kept"


def test_a_path_that_no_socket_can_have_is_measured(router: zmq.Socket[bytes], tmp_path: Path) -> None:
    path = f"{tmp_path}/{'a' * 107}"
    assert refusal(router, f"ipc://{path}") == f"a socket's path may have 107 bytes, and this has {len(path)}"


def test_a_port_in_use_is_said_to_be(router: zmq.Socket[bytes]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        said = refusal(router, f"tcp://127.0.0.1:{other.getsockname()[1]}")
    assert said == "another program listens there; end it, or choose another port"


@pytest.mark.parametrize("address", [ABSENT_ADDRESS, "no-such-host.invalid"])
def test_an_address_of_another_machine_is_said_to_be(router: zmq.Socket[bytes], address: str) -> None:
    assert refusal(router, f"tcp://{address}:5556").startswith("this machine has no such address; tcp://127.0.0.1:PORT")


@pytest.mark.parametrize(
    "endpoint",
    ["", "nonsense", "ipc://", "tcp://127.0.0.1", "tcp://127.0.0.1:99999", "tcp://127.0.0.1:80x", "udp://*:1"],
)
def test_what_is_no_endpoint_is_answered_with_the_forms_of_one(router: zmq.Socket[bytes], endpoint: str) -> None:
    assert refusal(router, endpoint) == FORMS


def test_an_endpoint_is_bound_and_again_after_a_server_that_was_killed(
    router: zmq.Socket[bytes], tmp_path: Path
) -> None:
    with socket.socket(socket.AF_UNIX) as abandoned:
        abandoned.bind(str(tmp_path / "control"))  # leaves its file
    endpoint = f"ipc://{tmp_path}/control"
    bind(router, endpoint, "control")
    assert router.last_endpoint == endpoint.encode()
    bind(router, "tcp://127.0.0.1:*", "control")


@pytest.mark.parametrize(
    "endpoint", ["tcp://0.0.0.0:1", "tcp://*:1", "tcp://192.0.2.7:1", "tcp://[::]:1", "tcp://eth0:1"]
)
def test_what_others_can_reach_is_bound_only_on_a_trusted_network(endpoint: str) -> None:
    with pytest.raises(InputError, match=r"--frames: .*every session that is watched and its id.*--trust-network"):
        check_trusted(endpoint, "frames", trusted=False)
    with pytest.raises(InputError, match=r"--control: .*changes and deletes every session.*--trust-network"):
        check_trusted(endpoint, "control", trusted=False)
    check_trusted(endpoint, "frames", trusted=True)


@pytest.mark.parametrize(
    "endpoint", ["ipc:///tmp/x", "tcp://127.0.0.1:1", "tcp://127.9.9.9:*", "tcp://[::1]:1", "tcp://lo:1"]
)
def test_what_only_this_machine_can_reach_needs_no_trust(endpoint: str) -> None:
    check_trusted(endpoint, "frames", trusted=False)
