"""The page in a folder of a proxy's site."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path

import httpx
import pytest

from e2e.conftest import ViewOf
from e2e.folder_proxy import FolderProxy
from e2e.folders import NGINX, haproxy, nginx
from e2e.server import PATIENCE, Server
from e2e.units import HAPROXY, WHY_NOT


def test_in_a_folder_that_the_proxy_takes_off_the_page_shows_moves_and_documents(
    view_of: ViewOf, server: Server
) -> None:
    with FolderProxy(server.url, "/user/ada/proxy/8000") as proxy:
        view = view_of()
        view.page.goto(f"{proxy.url}/?preset=matte")
        view.until("() => window.culet && culet.framesShown > 0")
        assert view.page.url.startswith(f"{proxy.url}/?session=")
        view.page.keyboard.press("p")
        view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0.05")
        view.until("() => document.querySelector('#scenes img')")
        thumbnail = str(view.page.evaluate("document.querySelector('#scenes img').src"))
        assert httpx.get(thumbnail, timeout=PATIENCE).headers["content-type"] == "image/webp"
        with httpx.Client(base_url=f"{proxy.url}/", timeout=PATIENCE) as http:
            made = http.post("api/sessions", json={"preset": "matte"})
            session = made.url.join(made.headers["location"])
            assert http.get(session).json()["id"] == made.json()["id"]
            assert made.url.join(made.json()["stream"]).path == f"{session.path}/stream"
            assert session.join(http.get(session).json()["stream"]).path == f"{session.path}/stream"
            assert http.delete(session).status_code == 204
            assert http.get("docs", follow_redirects=True).url.path.endswith("/8000/docs/")
            document = http.get("openapi.json")
            assert document.url.join(document.json()["servers"][0]["url"]).path == "/user/ada/proxy/8000/"
        view.page.goto("about:blank")
        assert [address for address in view.foreign if f"{proxy.url}/".partition("//")[2] not in address] == []
        view.foreign.clear()  # the proxy's site is another one than the server's
    server.until_equal("viewers", 0)


@pytest.mark.parametrize(
    "proxy",
    [
        pytest.param(
            nginx,
            marks=pytest.mark.skipif(
                NGINX is None, reason="there is no nginx on the PATH; Debian has it as the package nginx-light"
            ),
        ),
        pytest.param(haproxy, marks=pytest.mark.skipif(HAPROXY is None, reason=WHY_NOT)),
    ],
)
def test_by_the_configuration_of_the_documentation_the_page_is_in_a_folder(
    view_of: ViewOf, server: Server, tmp_path: Path, proxy: Callable[[str, Path], AbstractContextManager[str]]
) -> None:
    with ExitStack() as stack:
        url = stack.enter_context(proxy(server.url, tmp_path))
        view = view_of()
        view.page.goto(f"{url}/?preset=matte")
        view.until("() => window.culet && culet.framesShown > 0")
        assert view.page.url.startswith(f"{url}/?session=")
        view.page.keyboard.press("p")
        view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0.05")
        with httpx.Client(base_url=f"{url}/", timeout=PATIENCE) as http:
            made = http.post("api/sessions", json={"preset": "matte"}, headers={"Origin": url.removesuffix("/gems")})
            session = made.url.join(made.headers["location"])
            assert http.get(session).json()["id"] == made.json()["id"]
            large = {"file": ("stone.obj", b"#" * 2_000_000)}  # more than nginx passes on unasked
            assert http.post(f"{session}/meshes", files=large).status_code == 422
            assert http.delete(session).status_code == 204
        view.page.goto("about:blank")
        assert [address for address in view.foreign if f"{url}/".partition("//")[2] not in address] == []
        view.foreign.clear()  # the proxy's site is another one than the server's
    server.until_equal("viewers", 0)
