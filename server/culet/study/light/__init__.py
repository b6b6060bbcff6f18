"""The light that stones throw: its error and its cost."""
