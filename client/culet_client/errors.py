"""What can go wrong on the client's side.

ClientError
├── RefusedError   the server did not do what an event or a request asked for
└── SilenceError   nothing came in the time allowed
"""


class ClientError(Exception):
    """Something the user can put right: an address, an id, a folder; the message says which and how."""


class RefusedError(ClientError):
    """The server did not do what was asked for, and says why; the session lives on."""

    def __init__(self, message: str, field: str | None = None) -> None:
        super().__init__(message)
        self.field = field
        """The place in the input, such as `floor.kind`; None where it is about no place."""


class SilenceError(ClientError):
    """Nothing came in the time allowed."""
