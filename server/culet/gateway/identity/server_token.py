"""The server's token, and the cookie that stands for it in a browser."""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from ipaddress import ip_address

PATTERN = re.compile(r"[A-Za-z0-9_-]{16,200}")
"""What an address can hold, and nobody guesses."""
TOKEN_BYTES = 24
"""Of a token that is made: 192 bits, 32 characters."""
_COOKIE = b"culet cookie"


class Token:
    """Compared in a time that says nothing of where what was given differs."""

    def __init__(self, secret: str) -> None:
        self._secret = secret.encode()
        self.cookie = hmac.digest(self._secret, _COOKIE, hashlib.sha256).hex()
        """What a browser keeps: servers with the same token know it, and nobody can go back."""

    def is_it(self, given: str) -> bool:
        """Whether somebody knows it."""
        return hmac.compare_digest(given.encode(), self._secret)

    def is_cookie(self, given: str) -> bool:
        """Whether a browser was given the cookie."""
        return hmac.compare_digest(given.encode(), self.cookie.encode())


def made_token() -> str:
    """A new one."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def is_own_machine(host: str) -> bool:
    """Whether only this machine reaches what listens there."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
