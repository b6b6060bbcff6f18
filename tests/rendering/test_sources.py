"""The kernels' sources, joined for the compiler. That each compiles without a warning is `make check`'s claim."""

from __future__ import annotations

import re
from importlib.resources import files

import pytest

import culet_kernels


@pytest.mark.parametrize("name", culet_kernels.NAMES)
def test_joined_sources_keep_each_line_under_its_name_and_number(name: str) -> None:
    """So that the compiler's messages point at the source as it is written."""
    written = {each: files("culet_kernels").joinpath(each).read_text().splitlines() for each in culet_kernels.NAMES}
    file, number, met = name, 1, set()
    for line in culet_kernels.source(name).splitlines():
        marker = re.fullmatch(r'#line (\d+) "(\w+\.cl)"', line)
        if marker:
            number, file = int(marker[1]), marker[2]
            continue
        assert line == written[file][number - 1], f"{file}:{number}"
        met.add(file)
        number += 1
    assert name in met
