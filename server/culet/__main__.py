"""`python -m culet` is `culet`."""

from culet.cli import app

app()
