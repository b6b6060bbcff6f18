"""A reader that reads nothing and does not end."""

import sys

from culet.engine.library.upload_reader import ReadingOrder, limit

limit(ReadingOrder.of(sys.argv[1:]))
while True:
    pass
