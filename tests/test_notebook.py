"""A live view for notebooks: refusals, where its frame leads, its server's life. The tutorial's notebook shows one."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import numpy as np
import pytest
from PIL import Image

import culet
import culet_client
from culet import notebook
from culet.errors import CuletError, InputError
from culet_protocol.messages import ToggleMirror
from engine.peer import TETRAHEDRON


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"height": 49}, "height"),
        ({"height": True}, "height"),
        ({"rotate": float("nan")}, "rotate"),
        ({"through": "/proxy/8000/"}, "through"),
        ({"through": "proxy/{port}/"}, "through"),
    ],
)
def test_what_a_view_cannot_be_is_refused_before_a_server_is_started(given: dict[str, object], field: str) -> None:
    with pytest.raises(InputError, match="expected") as refused:
        culet.view("ruby", **given)  # type: ignore[arg-type]
    assert refused.value.field == field


@pytest.mark.parametrize("given", [{"mesh": "nowhere.obj"}, {"sky": "nowhere.exr"}])
def test_a_file_that_cannot_be_read_is_named_before_a_server_is_started(given: dict[str, str]) -> None:
    (name,) = given.values()
    with pytest.raises(CuletError, match=rf"{re.escape(name)}: "):
        culet.view("ruby", **given)  # type: ignore[arg-type]
    assert not notebook._servers


def test_under_jupyterhub_the_frame_leads_through_the_users_own_proxy(monkeypatch: pytest.MonkeyPatch) -> None:
    assert notebook._through(None) is None
    monkeypatch.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/")
    assert notebook._through(None) == "/user/ada/proxy/{port}/"
    assert notebook._through("https://hub.example/p/{port}") == "https://hub.example/p/{port}/"


def test_only_what_comes_through_a_proxy_may_bear_any_name() -> None:
    assert "--allow-host" not in notebook._options(None)
    given = notebook._options("https://hub.example/p/{port}/")
    assert given[given.index("--allow-host") + 1] == "*"
    assert (
        given[given.index("--frame-ancestor") + 1] == given[given.index("--allow-origin") + 1] == "https://hub.example"
    )


def test_views_share_a_server_that_ends_with_the_last(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CULET_TOKEN", "the-token-of-another-server")
    (tmp_path / "culet.toml").write_text('token = "one-of-a-file-for-others"')
    monkeypatch.setenv("CULET_CONFIG", str(tmp_path / "culet.toml"))  # a frame could give neither
    first = culet.view({"floor": {"kind": "matte"}}, ui=True)
    second = culet.view({"floor": {"kind": "none"}}, rotate=20)
    assert first.url.split("?")[0] == second.url.split("?")[0]
    source = re.search(
        r'src="(http://127\.0\.0\.1:\d+/\?session=[0-9a-f]{32}&amp;ui=0&amp;rotate=20)"', second._repr_html_()
    )
    assert source
    assert second.url == source[1].replace("&amp;", "&")
    with pytest.raises(culet_client.RefusedError) as refused:
        first.update({"floor": {"kind": "water"}})
    assert refused.value.field == "floor.kind"
    assert first.update({"floor": {"albedo": [0.2, 0.2, 0.2]}}).send(ToggleMirror()).scene.floor.kind == "mirror"
    assert np.asarray(first.picture(32, 18, samples=1)).shape == (18, 32, 3)
    policy = httpx.get(first.url).headers["Content-Security-Policy"]
    assert "frame-ancestors 'self' http://localhost:* http://127.0.0.1:*" in policy
    mesh, sky = tmp_path / "gem.off", tmp_path / "sky.png"
    mesh.write_bytes(TETRAHEDRON)
    Image.new("RGB", (16, 8), (255, 0, 255)).save(sky)
    given = culet.view({"floor": {"kind": "none"}, "backdrop": {"kind": "none"}}, mesh=mesh, sky=sky)
    assert given.scene.stones[0].mesh is not None
    shown = np.asarray(given.picture(32, 18, samples=1))
    red, green, blue = shown[0, 0]
    assert red > 100 < blue, "magenta, as the sky"
    assert green < 50
    given.stop()
    first.stop()
    first.stop()
    assert second.scene.floor.kind == "none"
    second.stop()
    with pytest.raises(httpx.ConnectError):
        httpx.get(second.url)
