"""What can go wrong on the client's side.

ClientError
└── SilenceError   nothing came in the time allowed
"""


class ClientError(Exception):
    """Something the user can put right: an address, an id, a folder; the message says which and how."""


class SilenceError(ClientError):
    """Nothing came in the time allowed."""
