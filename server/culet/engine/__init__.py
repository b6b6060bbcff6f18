"""The render process: sessions, their simulation and frames; control over ZeroMQ ROUTER, frames over XPUB."""
