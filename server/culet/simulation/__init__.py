"""Rigid bodies: state, integrators, contact."""
