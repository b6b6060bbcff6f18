"""The materials and the bands as tables: `python -m culet.optics.materials_page > docs/reference/materials.md`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.absorption import MATCHED_PATH_MM
from culet.optics.bands import bands
from culet.optics.gamut import desaturate
from culet.optics.material import Material
from culet.optics.materials import MATERIALS
from culet.optics.tone import tone_map
from culet.optics.wavelengths import LINE_B, LINE_C, LINE_D, LINE_F, LINE_G

Spectrum = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Radiance at each wavelength, nm."""

PATHS_MM = (2.0, MATCHED_PATH_MM, 10.0)
COUNTS = (4, 5, 6, 8, 16, 32)

INDICES = """# Materials

Made by `python -m culet.optics.materials_page > docs/reference/materials.md`; a test compares.

A scene names a material (`"material": "diamond"`), gives three indices (`{"ior": [r, g, b]}`, at 656.3, 546.1 and
435.8 nm) or Sellmeier's coefficients (`{"sellmeier": [[B, C], ...]}`, C in micrometres). With three bands each channel
has one index; with more, every band has its own.

Outside the range of its source no index is extrapolated: asking for one is an error, and a renderer asks for the index
at the nearer end of the range instead (moissanite below 435.8 nm, rutile and strontium titanate below 430, YAG and
emerald below 400). Three indices are joined by Cauchy's n = a + b / l^2 from line to line, and are constant beyond the
outer lines. A doubly refracting crystal is traced as if its ordinary ray were the only one.

n_F - n_C is the dispersion of opticians (486.1 and 656.3 nm), n_G - n_B that of gemmologists (430.8 and 686.7 nm),
V = (n_d - 1) / (n_F - n_C), the critical angle, in degrees, is for n_d (587.6 nm). A dash: outside the range.
"""

COLOURS = """## Colour

Absorption spectra are sums of bands that are Gaussian in wavenumber. Where the bands lie is published; how wide and
high they are is chosen, so that a stone of a few millimetres has its colour. They are models, not measurements. With
three bands each channel has one coefficient, such that white light has the same colour after 5 mm as by the spectrum.
Colours after a path are those of an equal-energy spectrum, in sRGB.
"""

BANDS = """## Bands

Wavelengths are sampled from 390 to 700 nm, one in each stratum of equal width; their weights in linear sRGB are divided
so that an equal-energy spectrum is exactly white in every group of wavelengths that a pixel takes. What that costs: a
few wavelengths in a group are biased, however many pixels and frames are averaged. The largest weight over all offsets,
and the largest component of the bias for white light after 5 mm of each coloured stone, and for light above 580 nm:
"""


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _number(value: Callable[[], float], digits: int) -> str:
    """The number, or a dash where the material has none."""
    try:
        return f"{value():.{digits}f}"
    except InputError:
        return "-"


def _index_row(material: Material) -> list[str]:
    def n(line: float) -> float:
        return float(material.index(line))

    return [
        material.name,
        *(_number(partial(n, line), 5) for line in (450, 550, 650, LINE_D)),
        _number(lambda: n(LINE_F) - n(LINE_C), 5),
        _number(lambda: (n(LINE_D) - 1) / (n(LINE_F) - n(LINE_C)), 2),
        _number(lambda: n(LINE_G) - n(LINE_B), 5),
        _number(lambda: float(np.degrees(np.arcsin(1 / n(LINE_D)))), 2),
        f"{material.span_nm[0]:g}-{material.span_nm[1]:g}",
    ]


def _source_row(material: Material) -> list[str]:
    notes = [material.summary, *([f"{material.ray.capitalize()}."] if material.ray else [])]
    return [material.name, " ".join(notes), material.confidence, material.source]


def transmittance(material: Material, path_mm: float, wavelength: NDArray[np.float64]) -> NDArray[np.float64]:
    """What is left of each wavelength after a path in the material, without reflection."""
    return np.exp(-path_mm * material.absorption_per_mm(wavelength))


def _hexadecimal(rgb: NDArray[np.float64]) -> str:
    return "`#" + "".join(f"{round(255 * c):02x}" for c in tone_map(desaturate(rgb), "srgb")) + "`"


def _colour_row(material: Material) -> list[str]:
    spectrum = material.absorption
    assert spectrum is not None  # noqa: S101  only coloured materials have a row
    return [
        material.name,
        "; ".join(f"{b.centre_nm:g} nm, {b.width_per_cm:g} /cm, {b.peak_per_mm:g} /mm" for b in spectrum.bands),
        ", ".join(f"{a:.3f}" for a in material.absorption_rgb_per_mm()),
        *(_hexadecimal(spectrum.colour_after(path)) for path in PATHS_MM),
        spectrum.source,
    ]


def largest_weight(count: int) -> float:
    """Over 201 offsets."""
    return max(float(np.abs(bands(count, offset).weights).max()) for offset in np.linspace(0, 1, 201))


def bias(spectrum: Spectrum, count: int) -> float:
    """How far the mean over offsets of what `count` wavelengths see is from what very many see, largest component."""

    def mean(count: int, offsets: int) -> NDArray[np.float64]:
        samples = (bands(count, (i + 0.5) / offsets) for i in range(offsets))
        return np.asarray(np.mean([spectrum(b.wavelength) @ b.weights for b in samples], axis=0))

    return float(np.abs(mean(count, 256) - mean(512, 8)).max())


def _above_580(wavelength: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(wavelength > 580, 1.0, 0.0)


def _band_row(count: int, coloured: Sequence[Material]) -> list[str]:
    spectra: list[Spectrum] = [
        *(partial(transmittance, material, MATCHED_PATH_MM) for material in coloured),
        _above_580,
    ]
    return [str(count), f"{largest_weight(count):.2f}", *(f"{bias(spectrum, count):.4f}" for spectrum in spectra)]


def page() -> str:
    """The whole page, Markdown."""
    all_of_them = list(MATERIALS.values())
    coloured = [material for material in all_of_them if material.absorption is not None]
    head = ["material", "n 450", "n 550", "n 650", "n_d", "n_F - n_C", "V", "n_G - n_B", "critical angle", "range, nm"]
    paths = [f"{path:g} mm" for path in PATHS_MM]
    parts = [
        INDICES,
        _table(head, map(_index_row, all_of_them)),
        _table(["material", "", "confidence", "source"], map(_source_row, all_of_them)),
        COLOURS,
        _table(
            [
                "material",
                "bands: centre, full width at half maximum, peak",
                "RGB, per mm",
                *paths,
                "source of positions",
            ],
            map(_colour_row, coloured),
        ),
        BANDS,
        _table(
            ["wavelengths", "largest weight", *(material.name for material in coloured), "above 580 nm"],
            (_band_row(count, coloured) for count in COUNTS),
        ),
        "Fewer than 4 are refused. With 8 or more the bias is below 0.002.\n",
    ]
    return "\n".join(parts)


if __name__ == "__main__":
    print(page(), end="")
