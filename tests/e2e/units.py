"""Several `culet serve` behind HAProxy with the configuration of docker/, as processes of this machine."""

from __future__ import annotations

import shutil
import ssl
import subprocess
import tempfile
from contextlib import ExitStack
from pathlib import Path

import httpx

from e2e.server import PATIENCE, Server, waited_until
from shared.ports import free_port

REPOSITORY = Path(__file__).parents[2]
CONFIGURATION = REPOSITORY / "docker" / "haproxy.cfg"
SILENCE = ("--engine-silence-seconds", "4")
TOKEN = "a-token-of-these-units"  # noqa: S105 - of these tests alone
LIVELY = {
    "floor": {"kind": "matte"},
    "simulation": {"restitution": 1, "tangential_damping": 1, "angular_damping": 1, "random_torque": 0},
}
"""A scene whose stone bounces for ever."""
HAPROXY = shutil.which("haproxy") or shutil.which("haproxy", path="/usr/sbin")
WHY_NOT = "there is no haproxy on the PATH; Debian has it as the package haproxy"


def configuration(folder: Path, ports: list[int], plain: int, encrypted: int) -> Path:
    """The file of docker/, with these units in place of those that Docker's name server knows."""
    text = CONFIGURATION.read_text()
    units = "\n".join(f"  server unit{number} 127.0.0.1:{port}" for number, port in enumerate(ports, 1))
    for line, own in (
        ('  server-template unit 1-16 "${CULET_UNITS}" resolvers units init-addr none', units),
        ("  bind :8080\n", f"  bind 127.0.0.1:{plain}\n"),
        ("  bind :8443 ssl crt /certificates/ ", f"  bind 127.0.0.1:{encrypted} ssl crt {folder}/certificates/ "),
        ('  nameserver one "${CULET_RESOLVER}"\n', "  nameserver one 127.0.0.1:53\n"),
    ):
        assert line in text, line
        text = text.replace(line, own)
    (folder / "haproxy.cfg").write_text(text)
    return folder / "haproxy.cfg"


def certificate(folder: Path) -> Path:
    """A certificate for localhost and its key in one file, as HAProxy wants it; returns the certificate alone."""
    (folder / "certificates").mkdir()
    own, key = folder / "own.pem", folder / "key.pem"
    names = "subjectAltName=DNS:localhost,IP:127.0.0.1"
    options = ["-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext", names]
    subprocess.run(["openssl", "req", "-x509", *options, "-keyout", key, "-out", own], check=True, capture_output=True)
    (folder / "certificates" / "site.pem").write_text(own.read_text() + key.read_text())
    return own


class Units:
    """The proxy and its units, which come one by one; all end with the `with`."""

    def __init__(self, most: int) -> None:
        self.ports = [free_port() for _ in range(most)]
        self.units: list[Server] = []
        self._stack = ExitStack()

    def __enter__(self) -> Units:
        assert HAPROXY
        folder = self._folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory()))
        plain, encrypted = free_port(), free_port()
        self.context = ssl.create_default_context(cafile=str(certificate(folder)))
        self.url = f"https://127.0.0.1:{encrypted}"
        self.plain = f"http://127.0.0.1:{plain}"
        file = configuration(folder, self.ports, plain, encrypted)
        log = self._stack.enter_context((folder / "haproxy.log").open("wb"))
        self._proxy = subprocess.Popen([HAPROXY, "-db", "-f", str(file)], stdout=log, stderr=log)
        self._stack.callback(self._end)
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def _end(self) -> None:
        self._proxy.terminate()
        self._proxy.wait(PATIENCE)

    def start(self) -> Server:
        """One more unit, ready."""
        number = len(self.units)
        folder = self._folder / f"unit{number + 1}"
        folder.mkdir()
        options = ("--no-spare", "--trusted-proxy", "127.0.0.1", "--token", TOKEN, "--drain-seconds", "300", *SILENCE)
        unit = Server(folder, *options, port=self.ports[number], stops_by_killing=True)
        self.units.append(self._stack.enter_context(unit))
        unit.http.headers["Authorization"] = f"Bearer {TOKEN}"  # or it would not say how it is
        return unit

    def client(self) -> httpx.Client:
        """Who was never here before."""
        return httpx.Client(base_url=self.url, verify=self.context, timeout=PATIENCE)

    def make(self) -> dict[str, str]:
        """A new session, by a client of its own."""
        with self.client() as http:
            made = http.post("/api/sessions", json={"preset": "matte"}, headers={"Authorization": f"Bearer {TOKEN}"})
            assert made.status_code == 201, made.text
            answer: dict[str, str] = made.json()
            return answer

    def has(self, unit: Server, session: str) -> bool:
        """Whether that unit has a session."""
        return unit.http.get(f"/api/sessions/{session}").status_code == 200

    def until_up(self, number: int) -> None:
        """Wait until the proxy gives new sessions to the first so many units."""

        def spread() -> bool:
            made = [self.make()["id"] for _ in range(number)]
            found = [any(self.has(unit, session) for session in made) for unit in self.units[:number]]
            with self.client() as http:
                for session in made:
                    http.delete(f"/api/sessions/{session}")
            return all(found)

        waited_until(spread)
