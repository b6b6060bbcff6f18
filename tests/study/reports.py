"""A small report, made up."""

from __future__ import annotations

from culet.study.report import Figure, Frontier, Headline, Point, Report


def report(seconds: float = 0.5, **changes: object) -> Report:
    points = tuple(
        Point(
            key=f"samples={n}",
            group="samples",
            label=f"samples {n}, <b> & so on",
            knobs={"samples": n, "polarised": False},
            figures={"frame_seconds": seconds * n, "rmse_model": 0.1 / n**0.5, "cut": None},
        )
        for n in (1, 4)
    )
    fields: dict[str, object] = {
        "study": "rendering",
        "made": "2026-01-02T03:04:05+00:00",
        "provenance": {"commit": "abc", "processor": "P", "units": 2},
        "settings": {"width": 32, "height": 18, "quick": True},
        "scene": {},
        "figures": {
            "frame_seconds": Figure(unit="s", about="Time."),
            "rmse_model": Figure(unit="radiance", about="Error."),
            "cut": Figure(unit="weight", about="Cut."),
        },
        "points": points,
        "frontiers": (Frontier(name="f", cost="frame_seconds", error="rmse_model", keys=("samples=1", "samples=4")),),
        "headlines": (Headline(name="a frame", value=1.2345, unit="ms"),),
    }
    return Report.model_validate(fields | changes)
