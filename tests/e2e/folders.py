"""nginx and HAProxy that show a server in a folder of their site, with the configuration of docs/how-to/deploy.md."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

from e2e.server import PATIENCE, waited_until
from e2e.units import HAPROXY
from shared.ports import free_port

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "deploy.md"
NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")
FOLDER = "/gems"
TEMPORARY = "client_body", "proxy", "fastcgi", "uwsgi", "scgi"
"""Kinds of folders that nginx makes as it begins, whether it needs them or not."""


def from_the_page(begins: str, server: str) -> str:
    """The example that begins so, for a server elsewhere."""
    (example,) = re.findall(rf"```\w+\n({begins}.*?)```", PAGE.read_text(), re.DOTALL)
    assert "127.0.0.1:8000" in example
    return str(example).replace("127.0.0.1:8000", urlsplit(server).netloc)


@contextmanager
def nginx(server: str, folder: Path) -> Iterator[str]:
    """Where it shows the server."""
    assert NGINX
    port = free_port()
    places = "\n".join(f"  {kind}_temp_path {folder}/{kind};" for kind in TEMPORARY)
    file = folder / "nginx.conf"
    file.write_text(
        f"{'user root;' if os.geteuid() == 0 else ''}\ndaemon off;\npid {folder}/nginx.pid;\nworker_processes 1;\n"
        f"error_log {folder}/error.log;\nevents {{}}\nhttp {{\n  access_log off;\n{places}\n"
        f"  server {{\n  listen 127.0.0.1:{port};\n{from_the_page('location /gems/', server)}  }}\n}}\n"
    )
    with running([NGINX, "-e", str(folder / "error.log"), "-p", str(folder), "-c", str(file)], port):
        yield f"http://127.0.0.1:{port}{FOLDER}"


@contextmanager
def haproxy(server: str, folder: Path) -> Iterator[str]:
    """Where it shows the server."""
    assert HAPROXY
    port = free_port()
    example = from_the_page("frontend site", server)
    assert "bind :80\n" in example
    defaults = "defaults\n  mode http\n  timeout connect 60s\n  timeout client 60s\n  timeout server 180s\n"
    file = folder / "haproxy.cfg"
    file.write_text(defaults + example.replace("bind :80\n", f"bind 127.0.0.1:{port}\n"))
    with running([HAPROXY, "-db", "-f", str(file)], port):
        yield f"http://127.0.0.1:{port}{FOLDER}"


@contextmanager
def running(command: list[str], port: int) -> Iterator[None]:
    """For as long as the `with` lasts, and listening."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def listens() -> bool:
        assert process.poll() is None, command
        with suppress(OSError), socket.create_connection(("127.0.0.1", port), PATIENCE):
            return True
        return False

    try:
        waited_until(listens)
        yield
    finally:
        process.terminate()
        process.wait(PATIENCE)
