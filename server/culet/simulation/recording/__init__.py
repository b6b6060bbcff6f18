"""The ways that stones take, recorded, written to files and drawn."""
