"""The report as a page: what was measured, in the order in which a reader asks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from culet.study.likeness.pictures import LEAST, MOST, inline, picture_paths, scale_bar
from culet.study.motion.simulation import DEFAULTS
from culet.study.pages.document import document, figure, heading, paragraph, picture, table, text
from culet.study.pages.plot import SHAPES, Mark, Series, log_log
from culet.study.report import Frontier, Point, Report

TITLES = {
    "rendering": "Error against run time: the renderer",
    "simulation": "Error against run time: the simulation",
    "streaming": "Size, time and likeness: the stream",
    "caustics": "Error against run time: the light that stones throw",
    "growth": "What grows, and how fast its cost does",
}

SHORTER = (("integrator ", ""), ("time step", "step"), ("contact step", "contact"), ("polarised yes", "polarised"))
"""Words of a label, and what a plot says instead."""
NAME_LENGTH = 42
"""Letters that a plot's margin has room for."""
LIMITS = {
    "single_flops": ("multiplications and additions, single precision", "Gflop/s"),
    "double_flops": ("multiplications and additions, double precision", "Gflop/s"),
    "bandwidth_per_second": ("copied, read and written", "GB/s"),
}
"""Of a report, in words."""

_SIMULATION_PLOTS = (
    ("rotation", "attitude_error"), ("rotation", "energy_error"), ("flight", "attitude_error"),
    ("bounce", "position_error"), ("slide", "position_error"), ("drop", "position_error"), ("drop", "attitude_error"),
)  # fmt: skip


def page(report: Report, pictures: Path) -> str:
    """The whole page; `pictures` is the folder of those that were made while measuring."""
    sections = {
        "rendering": _rendering, "simulation": _simulation, "streaming": _streaming, "caustics": _caustics,
        "growth": _growth,
    }[report.study]  # fmt: skip
    body = [*_opening(report), *sections(report, pictures), *_closing(report)]
    return document(TITLES[report.study], body)


def _opening(report: Report) -> Iterator[str]:
    settings = ", ".join(f"{name.replace('_', ' ')} {text(value)}" for name, value in report.settings.items())
    yield paragraph(f"Made {report.made[:10]}, {report.made[11:16]} UTC: {settings}.")
    if report.headlines:
        yield heading("In short")
        yield table(["", "value", "unit"], [(line.name, line.value, line.unit) for line in report.headlines])
    for note in report.notes:
        yield paragraph(note)


def _closing(report: Report) -> Iterator[str]:
    yield heading("Every figure")
    yield table(["figure", "unit", "about"], [(n, f.unit, f.about) for n, f in report.figures.items()])
    yield heading("Measured on")
    yield table(["", ""], [(name, str(value)) for name, value in report.provenance.items()])
    if report.limits:
        yield table(["the machine's limits", "", ""], [(*LIMITS[name], v / 1e9) for name, v in report.limits.items()])


def _rendering(report: Report, pictures: Path) -> Iterator[str]:
    points = [point for point in report.points if point.group != "race"]
    for frontier in report.frontiers:
        yield heading(frontier.name)
        yield from _frontier(report, points, frontier)
    if report.races:
        yield heading("Against others: seconds to reach an error")
        yield from _race_table(report, "renderer")
        series = [
            Series(race.name, _marks(_race_points(report, race.name), "race_seconds", "race_rmse"), line=True)
            for race in report.races
        ]
        yield figure(
            log_log(series, "seconds in the renderer", "RMSE, radiance"), "The same stone alone under a gradient sky."
        )
    yield heading("One knob at a time")
    yield paragraph(
        "Each knob is turned away from the base by itself. `paired` errors are against the model reference's picture "
        "of the same samples, so that they show the knob and not the sampling; `model` and `physics` errors are "
        "against the converged references."
    )
    columns = [
        "kernel_seconds", "frame_seconds", "prepare_seconds", "rmse_paired", "max_paired", "bias_paired", "rmse_model",
        "rmse_physics", "delta_e_model", "delta_e_physics", "cut", "segments", "non_finite",
    ]  # fmt: skip
    yield _table(points, columns, "setting")
    yield heading("What it looks like, and where the error is")
    yield figure(
        f'<img class="bar" src="{scale_bar()}" alt="from black to white">',
        f"Error maps: the largest error of a pixel's channels against the model reference, from {LEAST:g} (black) to "
        f"{MOST:g} (white), logarithmic. The first row are the references.",
    )
    shown = []
    references = [("model", "the model reference"), ("physics", "the physics reference")]
    for key, label in [*references, *((point.key, point.label) for point in points)]:
        image, error = picture_paths(pictures, key)
        if image.exists():
            shown.append(picture(inline(image), label))
            if key not in dict(references):
                shown.append(picture(inline(error), f"{label}: error"))
    yield '<div class="pictures">' + "".join(shown) + "</div>"


def _race_table(report: Report, first: str) -> Iterator[str]:
    rows = []
    for race in report.races:
        seconds = [
            None if s is None else f"{'~' if t in race.extrapolated else ''}{s:.3g}" for t, s in race.seconds.items()
        ]
        rows.append([race.name, *seconds, race.note])
    yield table([first, *(f"RMSE {target}" for target in report.races[0].seconds), ""], rows)
    yield paragraph("~ was not waited for: taken on from the last measured point along 1 / sqrt(time).")


def _growth(report: Report, pictures: Path) -> Iterator[str]:
    del pictures
    for fit in report.fits:
        own = [point for point in report.points if point.group == fit.label]
        marks = [Mark(float(point.knobs[fit.step] or 0), point.figures[fit.error] or 0.0, point.label) for point in own]
        yield heading(fit.label.capitalize())
        yield figure(
            log_log([Series("measured", marks, line=True)], fit.label, _axis(report, fit.error)),
            f"Grows as the number to the {fit.order:.2f}, by the larger {fit.points}.",
        )
        yield _table(own, [name for name in report.figures if any(p.figures[name] is not None for p in own)], "")


def _caustics(report: Report, pictures: Path) -> Iterator[str]:
    del pictures
    yield heading("Processor seconds to reach an error")
    yield from _race_table(report, "light, method")
    for frontier in report.frontiers:
        yield heading(frontier.name)
        lamp = frontier.name.split(":", 1)[0].lower()
        own = [point for point in report.points if point.knobs["lamp"] == lamp and point.group != "poses"]
        series = [
            Series(name, _marks([p for p in own if _way(p) == name], frontier.cost, frontier.error), line=True)
            for name in dict.fromkeys(map(_way, own))
        ]
        chosen = [report.point(key) for key in frontier.keys]
        yield figure(
            log_log(
                series, _axis(report, frontier.cost), _axis(report, frontier.error),
                _marks(chosen, frontier.cost, frontier.error),
            ),
            report.figures[frontier.error].about,
        )  # fmt: skip
        yield _numbered(chosen, frontier.cost, frontier.error)
    yield heading("The estimate beside the truth")
    poses = [point for point in report.points if point.group == "poses"]
    series = [
        Series(lamp, _marks([p for p in poses if p.knobs["lamp"] == lamp], "rmse", "rmse_estimated"))
        for lamp in dict.fromkeys(str(p.knobs["lamp"]) for p in poses)
    ]
    yield figure(
        log_log(series, _axis(report, "rmse"), _axis(report, "rmse_estimated")),
        "Stones turned at random: what a pass of one direction says of itself.",
    )
    yield from _groups(report, "map")


def _way(point: Point) -> str:
    """How a map was made, by the number of passes where that was chosen."""
    passes = f", passes {point.knobs['passes']}" if point.knobs["method"] == "beams" else ""
    return f"{point.knobs['method']}{passes}"


def _frontier(report: Report, points: list[Point], frontier: Frontier) -> Iterator[str]:
    if frontier.error == "rmse_paired":
        points = [point for point in points if point.knobs["samples"] == 1]
    drawn = Counter(point.group for point in points if point.figures.get(frontier.error))
    drawn.update({report.point(key).group: len(points) for key in frontier.keys})  # the frontier's before all others
    marked = sorted({"base", *(group for group, _ in drawn.most_common(len(SHAPES) - 2))})
    series = [Series(g, _marks([p for p in points if p.group == g], frontier.cost, frontier.error)) for g in marked]
    others = [point for point in points if point.group not in marked]
    series.append(Series("other knobs", _marks(others, frontier.cost, frontier.error)))
    chosen = [report.point(key) for key in frontier.keys]
    yield figure(
        log_log(
            series,
            _axis(report, frontier.cost),
            _axis(report, frontier.error),
            _marks(chosen, frontier.cost, frontier.error),
        ),
        f"{report.figures[frontier.error].about} The numbers are the frontier's, in the table below.",
    )
    yield _numbered(chosen, frontier.cost, frontier.error)


def _numbered(chosen: list[Point], cost: str, error: str) -> str:
    rows = [(n, point.label, point.figures[cost], point.figures[error]) for n, point in enumerate(chosen, 1)]
    return table(["", "on the frontier", cost.replace("_", " "), error.replace("_", " ")], rows)


def _axis(report: Report, figure_: str) -> str:
    unit = report.figures[figure_].unit
    return figure_.replace("_", " ") + (f", {unit}" if unit else "")


def _simulation(report: Report, pictures: Path) -> Iterator[str]:
    del pictures
    yield heading("Orders of convergence")
    yield table(
        ["integrator", "error", "order", "points"],
        [(fit.label, fit.error.replace("_", " "), fit.order, fit.points) for fit in report.fits],
    )
    for group, error in _SIMULATION_PLOTS:
        points = [point for point in report.points if point.group == group]
        frontiers = [frontier for frontier in report.frontiers if frontier.name == f"{group}: {error}"]
        yield heading(f"{group.capitalize()}: {error.replace('_', ' ')}")
        series = [
            Series(name, _marks([p for p in points if _method(p) == name], "cpu_seconds", error), line=True)
            for name in dict.fromkeys(map(_method, points))
        ]
        chosen = [report.point(key) for frontier in frontiers for key in frontier.keys]
        about = report.figures[error]
        yield figure(
            log_log(
                series,
                "processor seconds a simulated second",
                _axis(report, error),
                _marks(chosen, "cpu_seconds", error),
            ),
            about.about,
        )
        yield _numbered(chosen, "cpu_seconds", error)
    yield from _groups(report, "setting")


def _method(point: Point) -> str:
    knobs = point.knobs
    if point.group == "rotation":
        return str(knobs["integrator"])
    if knobs["model"] != "rigid":
        return str(knobs["model"])
    usual = knobs["contact_step"] == DEFAULTS.contact_step
    return f"rigid, {knobs['integrator']}" + ("" if usual else ", contact steps")


def _streaming(report: Report, pictures: Path) -> Iterator[str]:
    del pictures
    for frontier in report.frontiers:
        yield heading(frontier.name)
        points = [point for point in report.points if point.group == frontier.name.split(" ", 1)[0].lower()]
        series = []
        for name in dict.fromkeys(map(_family, points)):
            own = [point for point in points if _family(point) == name]
            series.append(Series(name, _marks(own, frontier.cost, frontier.error), line=name.startswith("JPEG")))
        chosen = [report.point(key) for key in frontier.keys]
        yield figure(
            log_log(series, "bytes a frame", "1 - SSIM", _marks(chosen, frontier.cost, frontier.error)),
            "Lossless codecs have no error and are in the tables alone.",
        )
        yield _numbered(chosen, frontier.cost, frontier.error)
    yield from _groups(report, "codec")


def _family(point: Point) -> str:
    return "JPEG " + str(point.knobs["subsampling"]) if point.knobs["codec"] == "jpeg" else point.label


def _race_points(report: Report, name: str) -> list[Point]:
    return [point for point in report.points if point.group == "race" and point.knobs["renderer"] == name]


def _marks(points: list[Point], x: str, y: str) -> list[Mark]:
    marks = []
    for point in points:
        across, up = point.figures.get(x), point.figures.get(y)
        if across and up:
            marks.append(Mark(across, up, f"{point.label}: {across:.3g}, {up:.3g}", _short(point.label)))
    return marks


def _short(label: str) -> str:
    """For the margin of a plot; the table below it has the whole."""
    for long, short in SHORTER:
        label = label.replace(long, short)
    return label if len(label) <= NAME_LENGTH else label[: NAME_LENGTH - 3] + "..."


def _groups(report: Report, first: str) -> Iterator[str]:
    yield heading("All points")
    for group in dict.fromkeys(point.group for point in report.points):
        yield heading(group.capitalize(), 3)
        yield _table([point for point in report.points if point.group == group], list(report.figures), first)


def _table(points: list[Point], figures: list[str], first: str) -> str:
    rows = [[p.label, *(p.figures.get(name) for name in figures)] for p in points]
    return table([first, *(name.replace("_", " ") for name in figures)], rows)
