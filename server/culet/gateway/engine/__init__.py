"""The engine as the gateway reaches it: where it is, requests to it and their replies, and its frames."""
