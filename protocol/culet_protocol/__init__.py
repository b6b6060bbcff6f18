"""The wire protocol between browser, gateway and engine: the source of truth for every other language.

`messages` holds what is said on the WebSocket as JSON, `parts` what a change of the scene is, `frame` the binary
frame, `watch` the id by which frames are found, `engine` what gateway and engine say to each other over ZeroMQ. The
specification is `protocol/README.md`.
"""

VERSION = 2
"""Raised when an old client could misunderstand a new server. Not the product's version."""

SUBPROTOCOL = f"culet.v{VERSION}"
"""WebSocket subprotocol; a client that asks for another one is refused with a readable reason."""

WATCH_SUBPROTOCOL = "culet.watch."
"""Before a session's watch id, which a viewer of `/api/stream` offers as a further subprotocol."""
