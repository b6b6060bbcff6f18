"""What the web process can be told; every limit in one place."""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ByteSize, Field, field_validator

from culet.errors import InputError
from culet.gateway.identity.client_address import read_proxies
from culet.gateway.identity.origins import Hosts, read_origin
from culet.gateway.identity.paths import FOLDER
from culet.gateway.identity.server_token import PATTERN, is_own_machine, made_token
from culet.settings import MEBIBYTE, Settings, Words, option, variable

log = logging.getLogger(__name__)

_IN_WHEEL = Path(__file__).parents[1] / "page"
_IN_CHECKOUT = Path(__file__).parents[3] / "client" / "web" / "dist"
BUILT_CLIENT = _IN_WHEEL if _IN_WHEEL.is_dir() else _IN_CHECKOUT
"""Where the web client's build lies."""


class GatewaySettings(Settings):
    """Endpoints of the engine, the address, and the gateway's limits."""

    control: str = Field(description="ZeroMQ endpoint of the engine's ROUTER.")
    frames: str = Field(description="ZeroMQ endpoint of the engine's XPUB.")
    host: str = Field("127.0.0.1", description="Address to listen on; 0.0.0.0 for every one.")
    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0 for a free one.")
    token: str | None = Field(
        None,
        repr=False,  # a secret: neither a log nor a message says it
        description="Who has it may do everything here, who has none only what a session's links let do; at least 16 "
        "letters, digits, - and _. One is made, and printed with the address, if other machines can reach the server: "
        "by --host, or by a proxy that --trusted-proxy or a name that --allow-host tells of.",
    )
    token_file: Path | None = Field(
        None,
        description="Keep the token in this file while the server runs, which only this user can read: for what looks "
        "after the server on this machine and does not know a token that was made.",
    )
    no_token: bool = Field(default=False, description="Make no token: whoever reaches the server may do everything.")
    open_health: bool = Field(default=True, description="Answer /healthz and /readyz without the token.")
    open_metrics: bool = Field(default=False, description="Answer /metrics without the token.")
    root_path: str = Field(
        "",
        description="Folder of a proxy's site that this server is shown in, such as /gems. Requests may come with it "
        "or without. Page and answers refer to each other relatively, so it is needed only where a proxy leaves it in "
        "what it passes on, and by cookies, which are then for that folder alone.",
    )
    web: Path = Field(BUILT_CLIENT, description="Folder of the built web client, served at /.")
    allow_host: Words = Field(
        (),
        description="A further name that this server goes by, such as gems.example, *.gems.example, or * for any; "
        "repeatable. Addresses, localhost and the host that is listened on are always names of it.",
    )
    allow_origin: Words = Field(
        (),
        description="A further page that may open streams and use the REST interface, such as https://gems.example; "
        "repeatable.",
    )
    allow_embedding: bool = Field(
        default=False, description="Let pages of any other site show pictures of /api, which take the engine's time."
    )
    frame_ancestor: Words = Field(
        (),
        description="A site, such as https://shop.example, whose pages may show the page in a frame; repeatable.",
    )
    trusted_proxy: Words = Field(
        (),
        description="Address or network of a proxy, such as 172.16.0.0/12, whose X-Forwarded-For says which client a "
        "request comes from; repeatable.",
    )
    max_connections: int = Field(
        1000,
        ge=16,
        description="Connections that may be open at once; fewer if the limit of open files leaves room for fewer.",
    )
    max_connections_per_address: int = Field(
        256, ge=8, description="Of those, from one address (behind a trusted proxy: requests at once and streams)."
    )
    head_seconds: float = Field(10, gt=0, description="Time for the head of a request to arrive.")
    min_body_rate: float = Field(
        1024, ge=0, description="Bytes a second that a request's body must make, and the reading of an answer."
    )
    session_idle_seconds: float = Field(
        900, gt=0, description="A session that nobody watched or asked about for so long is forgotten."
    )
    unwatched_session_seconds: float = Field(
        60, gt=0, description="A session that nobody ever watched is forgotten when nobody asked about it for so long."
    )
    max_client_sessions: int = Field(
        32,
        ge=1,
        description="Sessions that one client (an address, or the /64 of an IPv6 one) may have open. A client that has "
        "fewer than others gets room by those of theirs that nobody watches.",
    )
    max_viewers: int = Field(
        32, ge=1, description="Viewers of one session; one place is kept for the client that opened the session."
    )
    max_client_stills: int = Field(4, ge=1, description="Stills of one client that wait or are being rendered.")
    viewer_messages_per_second: float = Field(
        300,
        gt=0,
        description="Messages that one viewer may send, of up to 1 KiB each; what changes the session counts as 2.5. "
        "More wait in its connection; twice as many may come at once.",
    )
    client_messages_per_second: float = Field(
        1200,
        gt=0,
        description="The same for all viewers of one client together; a new stream counts as 10, a request as 1 to 5, "
        "a new session as 20. Requests that are too many get 429.",
    )
    max_body_bytes: ByteSize = Field(
        ByteSize(MEBIBYTE), ge=1024, description="Size of a request's body that is not an upload."
    )
    max_bodies_bytes: ByteSize = Field(
        ByteSize(256 * MEBIBYTE), ge=1, description="Size of all requests' bodies that are under way."
    )
    max_client_bodies_bytes: ByteSize = Field(
        ByteSize(128 * MEBIBYTE),
        ge=1,
        description="Size of those of one client (an address, or the /64 of an IPv6).",
    )
    max_kept_upload_bytes: ByteSize = Field(
        ByteSize(256 * MEBIBYTE),
        ge=1,
        description="Size of all uploads that are kept to be given to an engine again; those that sessions do not use "
        "go first, oldest first.",
    )
    uploads_folder: Path | None = Field(
        None,
        description="Folder where accepted uploads are kept too, so that a gateway that is started after one that died "
        "has them; one gateway's alone. culet serve has one for as long as it runs.",
    )
    drain_seconds: float = Field(
        0,
        ge=0,
        description="When told to stop (SIGTERM, or POST /api/drain), take no new sessions, and let those who are "
        "there stay for so many seconds; end before if all have left. 0 stops at once: right for a server alone, to "
        "which pages come back with their sessions once it is started again.",
    )
    request_seconds: float = Field(
        10, gt=0, description="An engine that lives but does not answer a small request for so long is unavailable."
    )
    engine_start_seconds: float = Field(
        10, ge=0, description="New sessions, and streams, wait so long for an engine that is starting."
    )
    engine_silence_seconds: float = Field(
        3.5, gt=1, description="Without a heartbeat (one a second) for so long, the engine counts as down."
    )

    @field_validator("token")
    @classmethod
    def _token(cls, given: str | None) -> str | None:
        if given is not None and PATTERN.fullmatch(given) is None:
            raise ValueError("expected 16 to 200 letters, digits, - and _")
        return given

    @field_validator("root_path")
    @classmethod
    def _folder(cls, given: str) -> str:
        given = given.rstrip("/")
        if FOLDER.fullmatch(given) is None or ".." in given.split("/"):
            raise ValueError("expected a folder such as /gems, of letters, digits, ., _, ~ and -")
        return given

    @field_validator("allow_host")
    @classmethod
    def _names(cls, given: tuple[str, ...]) -> tuple[str, ...]:
        Hosts(given)
        return given

    @field_validator("allow_origin")
    @classmethod
    def _origins(cls, given: tuple[str, ...]) -> tuple[str, ...]:
        """As browsers write them."""
        found = {text: read_origin(text) for text in given}
        if None in found.values():
            raise ValueError("expected an origin such as https://gems.example")
        return tuple(map(str, found.values()))

    @field_validator("trusted_proxy")
    @classmethod
    def _proxies(cls, given: tuple[str, ...]) -> tuple[str, ...]:
        read_proxies(given)
        return given

    @field_validator("frame_ancestor")
    @classmethod
    def _sources(cls, given: tuple[str, ...]) -> tuple[str, ...]:
        """Words of a Content-Security-Policy."""
        for text in given:
            if re.fullmatch(r"\*|https?:|(https?://)?(\*\.)?[\w.-]+(:(\d+|\*))?", text) is None:
                raise ValueError("expected a site such as https://shop.example")
        return given


def settings_of(given: Mapping[str, Any], control: str, frames: str) -> GatewaySettings:
    """The gateway's settings; InputError for one that cannot be used, a token and none at once, or a named folder that
    holds no built page."""
    settings = _with_token_or_without(GatewaySettings.read(given, control=control, frames=frames), given)
    look_for_page(settings)
    return settings


def _with_token_or_without(settings: GatewaySettings, given: Mapping[str, Any]) -> GatewaySettings:
    """An option has its way with the environment; else nobody can tell which of both is meant."""
    if settings.token is None or not settings.no_token:
        return settings
    match "token" in given, "no_token" in given:
        case False, True:
            return settings.model_copy(update={"token": None})
        case True, False:
            return settings.model_copy(update={"no_token": False})
    source = option("no_token") if "no_token" in given else variable("no_token")
    raise InputError(f"{source}: expected a token or none at all, got both; leave one of them out", "no_token")


def with_token(settings: GatewaySettings) -> GatewaySettings:
    """The settings with a token that is made, if others can reach the server and nothing was said about one."""
    if settings.token is not None or settings.no_token:
        return settings
    return settings.model_copy(update={"token": made_token() if is_reached(settings) else None})


def is_reached(settings: GatewaySettings) -> bool:
    """Whether other machines reach the server: by the address that is listened on, or by a proxy on this machine, since
    a server has a proxy that is trusted, or a name of its own, for no other reason."""
    return not is_own_machine(settings.host) or bool(settings.allow_host or settings.trusted_proxy)


def look_for_page(settings: GatewaySettings) -> None:
    """Say in the log that there is no page to serve; InputError if there is none in a folder that was named."""
    page = settings.web / "index.html"
    if "web" in settings.model_fields_set and not page.is_file():
        raise InputError(f"web: expected the folder of a built web client; there is no {page}", "web")
    if not page.is_file():
        log.warning(
            "there is no page to serve, only the REST interface: expected %s; build it by `make serve` or `make "
            "wheel`, or name its folder by --web",
            page,
        )
