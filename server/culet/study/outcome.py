"""From measured points to a report: frontiers, fits, races and the numbers that sum up; and its files."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from culet.errors import InputError
from culet.rendering.opencl.device import Device
from culet.study.bench.roofline import Roofline, counted_flops
from culet.study.findings.pareto import frontier
from culet.study.findings.provenance import provenance
from culet.study.light import caustics
from culet.study.motion import simulation
from culet.study.pages.page import page
from culet.study.renderer import race, rendering
from culet.study.renderer.knobs import Knobs
from culet.study.report import Frontier, Headline, Knob, Point, Race, Report, csv_text
from culet.study.serving import growth
from culet.study.stream import streaming

RACE_HEADLINE = "0.005"
"""RMSE of the race that is told first."""


def device_facts(device: Device) -> dict[str, str | int]:
    """What a report says of it."""
    return {"device": device.name, "driver": device.driver, "units": device.units, "lanes": device.lanes}


def rendering_report(
    scene: Mapping[str, object],
    settings: dict[str, Knob],
    facts: dict[str, str | int],
    points: Sequence[Point],
    base: Knobs,
    limits: Roofline,
    facets: int,
    notes: Sequence[str],
) -> Report:
    """Of `culet study rendering`."""
    swept = [point for point in points if point.group != "race"]
    single = [point for point in swept if point.knobs["samples"] == 1]
    races = race.results(points)
    return Report(
        study="rendering",
        made=_now(),
        provenance=provenance(facts),
        settings=settings,
        scene=dict(scene),
        figures={**rendering.FIGURES, **race.FIGURES},
        points=tuple(points),
        frontiers=(
            frontier("Time against the scene's own idea of light", swept, "frame_seconds", "rmse_model"),
            frontier("Time against the whole physics", swept, "frame_seconds", "rmse_physics"),
            frontier("One sample a pixel: time against the knob's own error", single, "kernel_seconds", "rmse_paired"),
        ),
        races=tuple(races),
        limits=limits._asdict(),
        headlines=(
            *_rendering_headlines(swept, base, limits, facets),
            *_race_headlines(points, races),
        ),
        notes=tuple(notes),
    )


def _rendering_headlines(points: Sequence[Point], base: Knobs, limits: Roofline, facets: int) -> list[Headline]:
    by_key = {point.key: point for point in points}
    own = by_key[base.key]
    kernel, segments = own.figures["kernel_seconds"] or 0.0, own.figures["segments"] or 0.0
    lines = [
        Headline(name="a frame of one sample, whole", value=1e3 * (own.figures["frame_seconds"] or 0.0), unit="ms"),
        Headline(name="of it in the kernel", value=1e3 * kernel, unit="ms"),
    ]
    if segments and base.geometry == "half-spaces":
        counted = counted_flops(segments, facets)
        share = counted / kernel / limits.single_flops
        lines.append(Headline(name="counted work of a frame, facet search alone", value=counted / 1e9, unit="Gflop"))
        lines.append(Headline(name="a segment inside the stone", value=1e9 * kernel / segments, unit="ns"))
        lines.append(Headline(name="share of the multiply-add peak, facet search alone", value=100 * share, unit="%"))
    for figure, words in (
        ("rmse_paired", "RMSE of all approximations together, sampling apart"),
        ("rmse_model", "RMSE of one sample a pixel, sampling included"),
        ("rmse_physics", "RMSE of one sample a pixel against the whole physics"),
        ("delta_e_model", "mean CIEDE2000 of one sample a pixel"),
        ("cut", "mean weight cut"),
    ):
        if (value := own.figures[figure]) is not None:
            lines.append(Headline(name=words, value=value, unit=rendering.FIGURES[figure].unit))
    for words, label in (
        ("double precision's time over single's", "precision double"),
        ("triangles' time over half-spaces'", "geometry triangles"),
        ("one lane's time over the widest's", "lanes 1"),
        ("precise maths' time over relaxed", "relaxed maths no"),
        ("classic estimator's time over the chain's", "estimator classic"),
        ("sixteen wavelengths' time over three indices'", "bands 16"),
        ("polarisation's time over none", "polarised yes"),
    ):
        other = next((point for point in points if point.label == label), None)
        if other is not None and kernel:
            lines.append(Headline(name=words, value=(other.figures["kernel_seconds"] or 0.0) / kernel, unit="x"))
    return lines


def _race_headlines(points: Sequence[Point], races: Sequence[Race]) -> list[Headline]:
    """Times to RACE_HEADLINE, and how many times culet's the others' are; also in time of all cores together."""
    lines = []
    for entry in races:
        if (seconds := entry.seconds.get(RACE_HEADLINE)) is not None:
            extrapolated = " (extrapolated)" if RACE_HEADLINE in entry.extrapolated else ""
            lines.append(Headline(name=f"{entry.name}: to RMSE {RACE_HEADLINE}{extrapolated}", value=seconds, unit="s"))
    in_processor_time = race.results(points, cost="race_processor_seconds")
    for words, timed in (("time", races), ("processor time", in_processor_time)):
        taken = {entry.name: entry.seconds.get(RACE_HEADLINE) for entry in timed}
        ours = taken.get("culet")
        lines += [
            Headline(name=f"{name}: {words} over culet's", value=seconds / ours, unit="x")
            for name, seconds in taken.items()
            if ours and seconds and name.startswith("Mitsuba")
        ]
    return lines


def simulation_report(scene: Mapping[str, object], settings: dict[str, Knob], points: Sequence[Point]) -> Report:
    """Of `culet study simulation`."""
    frontiers: list[Frontier] = []
    for group in dict.fromkeys(point.group for point in points):
        own = [point for point in points if point.group == group]
        frontiers += [
            frontier(f"{group}: {error}", own, "cpu_seconds", error)
            for error in ("position_error", "attitude_error", "energy_error")
            if any(point.figures[error] is not None for point in own)
        ]
    fits = simulation.fits_of(list(points))
    orders = [fit for fit in fits if fit.error == "attitude_error"]
    return Report(
        study="simulation",
        made=_now(),
        provenance=provenance({}),
        settings=settings,
        scene=dict(scene),
        figures=simulation.FIGURES,
        points=tuple(points),
        frontiers=tuple(frontiers),
        fits=tuple(fits),
        headlines=tuple(Headline(name=f"order of {fit.label}", value=fit.order, unit="") for fit in orders),
    )


def streaming_report(
    scene: Mapping[str, object], settings: dict[str, Knob], facts: dict[str, str | int], points: Sequence[Point]
) -> Report:
    """Of `culet study streaming`."""
    frontiers = [
        frontier(f"{group.capitalize()} frames", [p for p in points if p.group == group], "bytes", "dissimilarity")
        for group in dict.fromkeys(point.group for point in points)
    ]
    return Report(
        study="streaming",
        made=_now(),
        provenance=provenance(facts),
        settings=settings,
        scene=dict(scene),
        figures=streaming.FIGURES,
        points=tuple(points),
        frontiers=tuple(frontiers),
    )


def caustics_report(
    scene: Mapping[str, object],
    settings: dict[str, Knob],
    facts: dict[str, str | int],
    points: Sequence[Point],
    notes: Sequence[str],
) -> Report:
    """Of `culet study caustics`."""
    frontiers = [
        frontier(
            f"{lamp.capitalize()}: time against error", [p for p in points if p.knobs["lamp"] == lamp and
            p.group != "poses"], "processor_seconds", "rmse",
        )
        for lamp in caustics.LAMPS
    ]  # fmt: skip
    races = caustics.races(points)
    return Report(
        study="caustics",
        made=_now(),
        provenance=provenance(facts),
        settings=settings,
        scene=dict(scene),
        figures=caustics.FIGURES,
        points=tuple(points),
        frontiers=tuple(frontiers),
        races=tuple(races),
        headlines=tuple(_caustics_headlines(points, races)),
        notes=tuple(notes),
    )


def _caustics_headlines(points: Sequence[Point], races: Sequence[Race]) -> Iterator[Headline]:
    """Photons' time over beams', times of a map at rest, and how far estimates are from the truth."""
    by_name = {entry.name: entry for entry in races}
    for lamp in caustics.LAMPS:
        ours, theirs = (by_name[f"{lamp}, {method}"] for method in ("beams", "photons"))
        for target, seconds in ours.seconds.items():
            other = theirs.seconds[target]
            if seconds and other:
                told = ", extrapolated" if target in theirs.extrapolated else ""
                words = f"{lamp}: photons' processor time over beams', to RMSE {target}{told}"
                yield Headline(name=words, value=other / seconds, unit="x")
        for error in caustics.RESTING_TARGETS[lamp]:
            reached = caustics.rested(points, lamp, error)
            if reached is not None:
                yield Headline(name=f"{lamp}: at rest to RMSE {error:g}", value=reached, unit="s")
    ratios = [p.figures["estimate_ratio"] or 0.0 for p in points if p.group == "poses"]
    if ratios:
        yield Headline(name="estimated RMSE over true, least of all poses and cut-offs", value=min(ratios), unit="x")
        yield Headline(name="estimated RMSE over true, most of them", value=max(ratios), unit="x")
    bounded = [p for p in points if p.figures["bound"] and p.figures["missing"] is not None]
    if bounded:
        value = max((p.figures["missing"] or 0.0) / (p.figures["bound"] or 1.0) for p in bounded)
        yield Headline(name="light that is missing over its strict bound, most of all maps", value=value, unit="")


def growth_report(
    settings: dict[str, Knob], facts: dict[str, str | int], points: Sequence[Point], extent: growth.GrowthEffort
) -> Report:
    """Of `culet study growth`."""
    fits = growth.fits_of(points, extent)
    return Report(
        study="growth",
        made=_now(),
        provenance=provenance(facts),
        settings=settings,
        scene={},
        figures=growth.FIGURES,
        points=tuple(points),
        fits=tuple(fits),
        headlines=tuple(Headline(name=f"exponent of {fit.label}", value=fit.order, unit="") for fit in fits),
        notes=tuple(growth.steeper_than_they_should_be(fits, extent)),
    )


def write(report: Report, folder: Path) -> None:
    """report.html, report.json and report.csv; InputError for a folder that cannot be written to."""
    texts = {
        "report.json": report.json_text(),
        "report.csv": csv_text(report),
        "report.html": page(report, folder / "pictures"),
    }
    try:
        for name, text in texts.items():
            part = folder / f".{name}.part"
            part.write_text(text, encoding="utf-8")
            part.replace(folder / name)
    except OSError as error:
        raise InputError(f"out: cannot write to {folder}: {error.strerror}", "out") from error


def _now() -> str:
    return dt.datetime.now(dt.UTC).isoformat(timespec="seconds")
