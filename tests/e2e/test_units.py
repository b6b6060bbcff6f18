"""Several servers behind one proxy with TLS: sessions are found, and outlive the unit that they were in."""

from __future__ import annotations

import json
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL, WATCH_SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Resize
from e2e.server import PATIENCE, waited_until
from e2e.units import HAPROXY, LIVELY, TOKEN, WHY_NOT, Units, certificate, configuration
from shared.ports import free_port

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


def stream_of(units: Units, path: str, *protocols: str) -> ClientConnection:
    """By the proxy and TLS."""
    address = f"{units.url}{path}".replace("https", "wss", 1)
    offered = [Subprotocol(SUBPROTOCOL), *map(Subprotocol, protocols)]
    return connect(
        address, ssl=units.context, subprotocols=offered, compression=None, max_size=None, open_timeout=PATIENCE
    )


def frame_of(units: Units, path: str, *protocols: str) -> Frame:
    """The first frame of a stream."""
    with stream_of(units, path, *protocols) as stream:
        stream.send(Resize(width=64, height=36).model_dump_json())
        while isinstance(message := stream.recv(PATIENCE), str):
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


def viewers_of(units: Units) -> list[float]:
    """How many each unit has."""
    return [unit.metrics()["viewers"] for unit in units.units]


@pytest.mark.soak
def test_twenty_links_of_shared_sessions_lead_clean_clients_to_the_units_that_have_them(units: Units) -> None:
    """As pages open them, ten that steer and ten that watch: all at once, and without a cookie."""
    made = [units.make() for _ in range(20)]
    holders = [[units.has(unit, each["id"]) for unit in units.units] for each in made]
    assert all(sum(has) == 1 for has in holders)
    with ExitStack() as opened:
        for number, each in enumerate(made):
            if number % 2:
                stream = opened.enter_context(stream_of(units, f"/api/sessions/{each['id']}/stream"))
            else:
                stream = opened.enter_context(stream_of(units, "/api/stream", WATCH_SUBPROTOCOL + each["watch"]))
            hello = json.loads(stream.recv(PATIENCE))
            assert (hello["type"], hello["watch"], hello["steers"]) == ("hello", each["watch"], number % 2 == 1)
        held = [sum(has) for has in zip(*holders, strict=True)]
        assert min(held) > 0, "sessions are spread"
        assert viewers_of(units) == held
    waited_until(lambda: viewers_of(units) == [0] * len(held))
    with units.client() as http:
        for each in made:
            assert http.delete(f"/api/sessions/{each['id']}").status_code == 204


@pytest.mark.soak
def test_a_page_whose_engine_is_killed_goes_on_by_itself_and_its_unit_is_out_until_it_has_another(
    units: Units, browser: Browser
) -> None:
    with units.client() as http:
        answer = http.post("/api/sessions", json={"scene": LIVELY}, headers={"Authorization": f"Bearer {TOKEN}"})
        session = answer.json()["id"]
        assert http.post(f"/api/sessions/{session}/events", json={"type": "toggle_fall"}).status_code == 200
    page = page_on(units, browser, f"?session={session}")
    waited_until(lambda: float(page.evaluate(TIME_OF)) > 0.5)
    unit, other = sorted(units.units[:2], key=lambda unit: not units.has(unit, session))
    before, address = float(page.evaluate(TIME_OF)), page.url
    with unit.engine_gone():
        assert unit.http.get("/readyz").status_code == 503
        waited_until(lambda: units.has(other, session))  # the page has it made again, as it was
        waited_until(lambda: float(page.evaluate(TIME_OF)) > before)
        assert page.evaluate("culet.state.falling")
        assert page.url == address
        made = [units.make()["id"] for _ in range(4)]
        assert all(units.has(other, each) for each in made), "whoever is new comes where a picture can be made"
    waited_until(lambda: unit.http.get("/readyz").status_code == 200)
    units.until_up(2)
    page.context.close()
    with units.client() as http:
        for each in (session, *made):
            assert http.delete(f"/api/sessions/{each}").status_code == 204


def page_on(units: Units, browser: Browser, query: str) -> Page:
    context = browser.new_context(ignore_https_errors=True, viewport={"width": 384, "height": 216})
    context.set_default_timeout(PATIENCE * 1e3)
    page = context.new_page()
    page.goto(f"{units.url}/{query}#token={TOKEN}")
    waited_until(lambda: bool(page.evaluate("!!window.culet && culet.framesShown > 0")))
    return page


TIME_OF = "culet.lastFrame.simulationTime"


@pytest.mark.soak
def test_a_page_whose_unit_dies_goes_on_by_itself_in_another_one(units: Units, browser: Browser) -> None:
    """With pose and motion: a ball that bounces for ever has fallen for as long as before, and falls on."""
    headers = {"Authorization": f"Bearer {TOKEN}"}
    with units.client() as http:
        session = http.post("/api/sessions", json={"scene": LIVELY}, headers=headers).json()["id"]
        http.post(f"/api/sessions/{session}/events", json={"type": "toggle_fall"})
    pages = [page_on(units, browser, f"?session={session}") for _ in range(2)]
    waited_until(lambda: float(pages[0].evaluate(TIME_OF)) > 3)
    unit = next(unit for unit in units.units if units.has(unit, session))
    before = float(pages[0].evaluate(TIME_OF))
    unit.kill()
    others = [other for other in units.units if other is not unit]
    waited_until(lambda: any(units.has(other, session) for other in others))
    for page in pages:
        waited_until(lambda page=page: float(page.evaluate(TIME_OF)) > before + 0.5)  # type: ignore[misc]
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
