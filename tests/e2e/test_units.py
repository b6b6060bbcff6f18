"""Several servers behind one proxy with TLS: sessions are found, and outlive the unit that they were in."""

from __future__ import annotations

import json
import subprocess
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL, WATCH_SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Resize
from e2e.server import waited_until
from e2e.units import HAPROXY, TOKEN, WHY_NOT, Units, certificate, configuration, free_port

pytestmark = pytest.mark.skipif(HAPROXY is None, reason=WHY_NOT)


def test_haproxy_takes_the_configuration(tmp_path: Path) -> None:
    certificate(tmp_path)
    file = configuration(tmp_path, [free_port()], free_port(), free_port())
    checked = subprocess.run([str(HAPROXY), "-c", "-f", file], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "[WARNING]" not in checked.stdout + checked.stderr


@pytest.fixture(scope="module")
def units(built_client: None) -> Iterator[Units]:
    """Two of three."""
    with Units(3) as running:
        running.start()
        running.start()
        running.until_up(2)
        yield running


def frame_of(units: Units, path: str, *protocols: str) -> Frame:
    """The first frame of a stream, by the proxy and TLS."""
    address = f"{units.url}{path}".replace("https", "wss", 1)
    offered = [Subprotocol(SUBPROTOCOL), *map(Subprotocol, protocols)]
    with connect(address, ssl=units.context, subprotocols=offered, compression=None, max_size=None) as stream:
        stream.send(Resize(width=64, height=36).model_dump_json())
        while isinstance(message := stream.recv(60), str):
            assert json.loads(message)["type"] != "problem", message
        return Frame.unpack(message)


@pytest.mark.soak
def test_sessions_are_spread_and_found_by_clean_clients_through_tls(units: Units) -> None:
    made = [units.make() for _ in range(6)]
    where = Counter(next(n for n, unit in enumerate(units.units) if units.has(unit, each["id"])) for each in made)
    assert set(where.values()) == {3}, "three in each"
    for each in made * 3:
        for name in (each["id"], each["watch"]):
            with units.client() as http:  # who has no cookie, and no connection that was there before
                answer = http.get(f"/api/sessions/{name}")
                assert (answer.status_code, answer.json()["id"]) == (200, name)
                assert "strict-transport-security" in answer.headers
    for each in made[:2]:
        shown = frame_of(units, f"/api/sessions/{each['id']}/stream")
        watched = frame_of(units, "/api/stream", WATCH_SUBPROTOCOL + each["watch"])
        assert shown.watch.hex() == watched.watch.hex() == each["watch"]
    with units.client() as http:
        for each in made:
            assert http.delete(f"/api/sessions/{each['id']}").status_code == 204


def page_on(units: Units, browser: Browser, query: str) -> Page:
    page = browser.new_context(ignore_https_errors=True, viewport={"width": 384, "height": 216}).new_page()
    page.goto(f"{units.url}/{query}#token={TOKEN}")
    waited_until(lambda: bool(page.evaluate("!!window.culet && culet.framesShown > 0")))
    return page


LIVELY = {
    "floor": {"kind": "matte"},
    "simulation": {"restitution": 1, "tangential_damping": 1, "angular_damping": 1, "random_torque": 0},
}


@pytest.mark.soak
def test_a_page_whose_unit_dies_goes_on_by_itself_in_another_one(units: Units, browser: Browser) -> None:
    """With pose and motion: a ball that bounces for ever has fallen for as long as before, and falls on."""
    headers = {"Authorization": f"Bearer {TOKEN}"}
    with units.client() as http:
        session = http.post("/api/sessions", json={"scene": LIVELY}, headers=headers).json()["id"]
        http.post(f"/api/sessions/{session}/events", json={"type": "toggle_fall"})
    pages = [page_on(units, browser, f"?session={session}") for _ in range(2)]
    time_of = "culet.lastFrame.simulationTime"
    waited_until(lambda: float(pages[0].evaluate(time_of)) > 3)
    unit = next(unit for unit in units.units if units.has(unit, session))
    before = float(pages[0].evaluate(time_of))
    unit.kill()
    others = [other for other in units.units if other is not unit]
    waited_until(lambda: any(units.has(other, session) for other in others))
    for page in pages:
        waited_until(lambda page=page: float(page.evaluate(time_of)) > before + 0.5)  # type: ignore[misc]
        assert page.evaluate("culet.state.falling")
        page.context.close()
    assert sum(units.has(other, session) for other in others) == 1, "both pages found the same unit"


@pytest.mark.soak
def test_one_more_unit_gets_sessions_and_one_that_drains_keeps_its_own_and_gets_none(units: Units) -> None:
    new = units.start()
    old = next(unit for unit in units.units if unit.is_running and unit is not new)

    def has_a_new_one() -> bool:
        return units.has(new, units.make()["id"])

    waited_until(has_a_new_one)
    own = next(each for each in iter(units.make, None) if units.has(old, each["id"]))
    begun = old.http.post("/api/drain", json={"seconds": 250}, headers={"Authorization": f"Bearer {TOKEN}"})
    assert begun.status_code == 202
    with units.client() as http:
        headers = {"Authorization": f"Bearer {TOKEN}"}
        # Until the proxy has asked how the unit is, the unit itself refuses.
        waited_until(lambda: [http.post("/api/sessions", headers=headers).status_code for _ in range(4)] == [201] * 4)
        assert not any(units.has(old, units.make()["id"]) for _ in range(4))
        for name in (own["id"], own["watch"]):
            assert http.get(f"/api/sessions/{name}").status_code == 200, "it keeps what it has"
        assert http.delete(f"/api/sessions/{own['id']}").status_code == 204
