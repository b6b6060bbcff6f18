"""The work of the facet search, counted by hand."""

from __future__ import annotations

from culet.study.bench.roofline import counted_flops


def test_a_segment_asks_every_facet_for_two_dot_products() -> None:
    # n.d is 3 multiply-adds, w - n.o is 3, each of 2 operations
    assert counted_flops(segments=10, facets=73) == 10 * 73 * 12
