"""A reader that reads nothing and does not end."""

import sys

from culet.engine.library.upload_reader import Order, limit

limit(Order.of(sys.argv[1:]))
while True:
    pass
