"""Keys between machines: an engine that lets in who has them, by the real processes."""

from __future__ import annotations

import asyncio
import socket
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from culet.cli import app
from culet.endpoints import check_trusted
from culet.errors import InputError
from culet.gateway.engine.engine_door import check_one_engine
from culet.service.command_lines import engine_command
from culet_client import ClientError, FrameSubscription, SilenceError, connect
from culet_protocol.keys import ClientKeys, EngineKeys, KeysError, make_keys
from culet_protocol.watch import watch_id
from gateway.running import PATIENCE, Endpoints, engine_process, gateway_before
from shared.ports import free_port


def test_each_machine_gets_a_folder_that_only_its_owner_reads(tmp_path: Path) -> None:
    folder = tmp_path / "keys"
    made = CliRunner().invoke(app, ["keys", str(folder), "--for", "gateway", "--for", "viewer"])
    assert made.exit_code == 0, made.output
    assert made.output.split() == [str(folder / name) for name in ("engine", "gateway", "viewer")]
    secrets = list(folder.rglob("*.key_secret"))
    assert len(secrets) == 3
    assert {file.stat().st_mode & 0o777 for file in secrets} == {0o600}
    gateway, viewer = ClientKeys.read(folder / "gateway"), ClientKeys.read(folder / "viewer")
    assert gateway.engine == viewer.engine
    assert gateway.secret != viewer.secret
    engine = EngineKeys.read(folder / "engine")
    assert {file.stem for file in engine.allowed.glob("*.key")} == {"gateway", "viewer"}
    given_away = [file for name in ("gateway", "viewer") for file in (folder / name).iterdir()]
    assert not any(engine.secret in file.read_bytes() for file in given_away)
    assert not any(each.secret.decode() in repr(each) for each in (gateway, engine)), "no log has a secret"
    make_keys(folder, ["later"])
    assert EngineKeys.read(folder / "engine") == engine, "the engine keeps its own"
    assert (engine.allowed / "later.key").is_file()


def test_keys_that_cannot_be_used_are_refused_with_what_to_do(tmp_path: Path) -> None:
    make_keys(tmp_path, ["gateway"])
    for name in ("gateway", "engine", "a/b", "Ada"):
        refused = CliRunner().invoke(app, ["keys", str(tmp_path), "--for", name])
        assert refused.exit_code != 0
    with pytest.raises(KeysError, match="`culet keys` makes such folders"):
        ClientKeys.read(tmp_path / "nowhere")
    with pytest.raises(KeysError, match="is no engine's folder of keys"):
        EngineKeys.read(tmp_path / "gateway")
    (tmp_path / "gateway" / "own.key_secret").chmod(0o644)
    with pytest.raises(KeysError, match="run `chmod 600"):
        ClientKeys.read(tmp_path / "gateway")
    with pytest.raises(InputError, match=r"--frames: .*--keys lets in those who have keys"):
        check_trusted("tcp://0.0.0.0:5556", "frames", trusted=False)


async def test_an_engine_with_keys_serves_who_has_them_and_nobody_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_keys(tmp_path / "ours", ["gateway", "viewer"])
    make_keys(tmp_path / "theirs", ["stranger"])
    # A stranger who knows the engine's public key, and is not one of those it knows.
    engine_key = (tmp_path / "ours" / "gateway" / "engine.key").read_bytes()
    (tmp_path / "theirs" / "stranger" / "engine.key").write_bytes(engine_key)
    control, frames = f"tcp://127.0.0.1:{free_port()}", f"tcp://127.0.0.1:{free_port()}"

    def command(own_control: str, own_frames: str) -> list[str]:
        del own_control
        options = ("--keys", str(tmp_path / "ours" / "engine"))
        return engine_command(control, own_frames, frames, options=options)

    with engine_process(command) as local:
        endpoints = Endpoints(control, frames)
        async with gateway_before(endpoints, web=tmp_path, keys=tmp_path / "ours" / "gateway") as gateway:
            session = await gateway.session()
            async with gateway.viewer(session) as viewer:
                await viewer.frame()
                subscribe = partial(FrameSubscription, watch=watch_id(session))
                with subscribe(frames, keys=tmp_path / "ours" / "viewer") as ours, subscribe(local.frames) as here:
                    for own in (ours, here):
                        assert (await asyncio.to_thread(own.receive, PATIENCE)).watch.hex() == watch_id(session)
                    for keys in (None, tmp_path / "theirs" / "stranger"):
                        with subscribe(frames, keys=keys) as stranger, subscribe(local.frames) as another:
                            await asyncio.to_thread(another.receive, PATIENCE)  # the picture is sent again for that one
                            await asyncio.to_thread(another.receive, PATIENCE)  # and again, after a while
                            with pytest.raises(SilenceError):
                                await asyncio.to_thread(stranger.receive, 0.1)
                        with pytest.raises(SilenceError):
                            await asyncio.to_thread(connect, frames, control=control, keys=keys, timeout_seconds=0.5)
                monkeypatch.setenv("CULET_KEYS", str(tmp_path / "ours" / "viewer"))
                ours_by_default = partial(connect, frames, session=session, timeout_seconds=PATIENCE)
                with await asyncio.to_thread(ours_by_default) as connection:
                    await asyncio.to_thread(connection.image, PATIENCE)
    monkeypatch.setenv("CULET_KEYS", str(tmp_path))
    with pytest.raises(ClientError, match="cannot read the secret key"):
        FrameSubscription(frames, "0" * 32)


def test_one_gateway_is_not_put_before_two_engines(monkeypatch: pytest.MonkeyPatch) -> None:
    def known(host: str, *_: object) -> list[tuple[int, int, int, str, tuple[str, int]]]:
        if host == "nowhere":
            raise socket.gaierror
        addresses = ("10.0.0.2", "10.0.0.3") if host == "engine" else ("10.0.0.2",)
        return [(2, 1, 6, "", (address, 0)) for address in addresses]

    monkeypatch.setattr(socket, "getaddrinfo", known)
    check_one_engine({"control": "tcp://one:5555", "frames": "ipc:///tmp/frames"})
    check_one_engine({"control": "tcp://nowhere:5555"})
    with pytest.raises(InputError, match=r"--frames: expected the address of one engine.* the name of 2"):
        check_one_engine({"control": "tcp://one:5555", "frames": "tcp://engine:5556"})
