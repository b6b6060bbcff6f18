"""Thin Python client: frames over ZeroMQ."""
