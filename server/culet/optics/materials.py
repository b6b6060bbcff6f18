"""The named materials, with the source of every number, and the material that a scene asks for.

The refractiveindex.info database (M. N. Polyanskiy, Sci. Data 11, 94 (2024), CC0) was the way to most of the sources.
Doubly refracting crystals are given by their ordinary ray.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from culet.errors import SceneError
from culet.optics.absorption import AbsorptionSpectrum, GaussianBand
from culet.optics.formulas import Cauchy, Sellmeier, SinglePole, ThroughLines
from culet.optics.material import Material
from culet.optics.wavelengths import RGB_NANOMETRES
from culet.scene.stone import IndexMaterial, SellmeierMaterial

VISIBLE_NANOMETRES = (380.0, 780.0)
"""The range of a formula that comes without one."""

PETER_1923 = ((0.3306, 0.1750), (4.3356, 0.1060))
"""Diamond: Sellmeier pairs (B, C in micrometres)."""

CLASSIC_INDICES = (1.7, 1.8, 1.9)
"""The report's indices, chosen by its author to exaggerate the fire."""

CORUNDUM = Sellmeier(((1.4313493, 0.0726631), (0.65054713, 0.1193242), (5.3414021, 18.028251)))
CORUNDUM_SOURCE = (
    "I. H. Malitson, M. J. Dodge, J. Opt. Soc. Am. 62, 1405 (1972); formula in M. J. Dodge, Handbook of Laser Science "
    "and Technology IV, CRC Press (1986), p. 30: colourless synthetic sapphire, 20 C"
)
CORUNDUM_SPAN = (200.0, 5000.0)

RUBY_BANDS = AbsorptionSpectrum(
    (GaussianBand(556, 2500, 1.5), GaussianBand(410, 5000, 2.1)),
    "Cr3+ at 405-410 and 550-560 nm: GRS Gemresearch Swisslab, Journal 1 (2002), fig. 26; 4A2 to 4T2 at 18 300 1/cm: "
    "B. J. Reddy, L. R. Moorthy, Pramana 19, 449 (1982); heights of a deep red stone",
)
SAPPHIRE_BANDS = AbsorptionSpectrum(
    (
        GaussianBand(580, 5200, 0.28),
        GaussianBand(710, 3500, 0.06),
        GaussianBand(450, 900, 0.03),
        GaussianBand(388, 1500, 0.05),
    ),
    "Fe2+-Ti4+ charge transfer, first explained by M. G. Townsend, Solid State Commun. 6, 81 (1968), reported from 580 "
    "to 710 nm; Fe3+ at 450 and 388 nm: GRS Gemresearch Swisslab, Journal 1 (2002), fig. 26",
)
EMERALD_BANDS = AbsorptionSpectrum(
    (GaussianBand(430, 4000, 0.34), GaussianBand(605, 3000, 0.26)),
    "Cr3+ at 430 and 600 nm: J.-M. Derochette, polarised spectra of a Brazilian emerald of 2 mm (jm-derochette.be)",
)

_ALL = (
    Material(
        "diamond",
        "Diamond",
        "Diamond, the usual reference.",
        Sellmeier(PETER_1923),
        "F. Peter, Z. Phys. 15, 358 (1923)",
        (226, 760),
    ),
    Material(
        "diamond-turri",
        "Diamond, grown",
        "Diamond grown from vapour (type IIa), within 0.002.",
        Sellmeier(((4.658, 0.1125),)),
        "G. Turri et al., Opt. Mater. Express 7, 855 (2017)",
        (300, 1650),
    ),
    Material(
        "moissanite",
        "Moissanite",
        "Silicon carbide 6H: more fire than diamond; its strong double refraction is not traced.",
        SinglePole(6.57232, 0.1401, 0.03178, 0.02153),
        "S. Wang et al., Laser Photonics Rev. 7, 831 (2013)",
        (435.8, 2325),
        ray="ordinary ray",
    ),
    Material(
        "cubic-zirconia",
        "Cubic zirconia",
        "Zirconia with 12 mol% yttria.",
        Sellmeier(((1.347091, 0.062543), (2.117788, 0.166739), (9.452943, 24.320570))),
        "D. L. Wood, K. Nassau, Appl. Opt. 21, 2978 (1982)",
        (361, 5135),
    ),
    Material(
        "sapphire",
        "Sapphire",
        "Corundum coloured blue by iron and titanium.",
        CORUNDUM,
        CORUNDUM_SOURCE,
        CORUNDUM_SPAN,
        ray="ordinary ray",
        absorption=SAPPHIRE_BANDS,
    ),
    Material(
        "ruby",
        "Ruby",
        "Corundum coloured red by chromium; its fluorescence is not traced.",
        CORUNDUM,
        CORUNDUM_SOURCE,
        CORUNDUM_SPAN,
        ray="ordinary ray",
        absorption=RUBY_BANDS,
    ),
    Material(
        "emerald",
        "Emerald",
        "Beryl coloured green by chromium; no measured dispersion formula of beryl was found.",
        Cauchy(1.566794, 0.004273),
        "Cauchy fit to gemmological tables (n_d 1.579), from the materials of gemray-studio",
        (400, 700),
        ray="ordinary ray",
        confidence="weak source",
        absorption=EMERALD_BANDS,
    ),
    Material(
        "spinel",
        "Spinel",
        "Magnesium aluminate, colourless.",
        Sellmeier(((1.8938, 0.09942), (3.0755, 15.826))),
        "W. J. Tropf, M. E. Thomas in Handbook of Optical Constants of Solids II (1991), p. 881; formula in Handbook "
        "of Optics, 3rd ed., vol. 4 (2009)",
        (350, 5500),
    ),
    Material(
        "yag",
        "YAG garnet",
        "Yttrium aluminium garnet, undoped.",
        Sellmeier.of_squares((2.28200, 0.01185), (3.27644, 282.734)),
        "D. E. Zelmon, D. L. Small, R. Page, Appl. Opt. 37, 4933 (1998)",
        (400, 5000),
    ),
    Material(
        "quartz",
        "Rock crystal",
        "Crystalline quartz: rock crystal.",
        Sellmeier.of_squares((1.07044083, 1.00585997e-2), (1.10202242, 100), constant=1.28604141),
        "G. Ghosh, Opt. Commun. 163, 95 (1999)",
        (198, 2053.1),
        ray="ordinary ray",
    ),
    Material(
        "strontium-titanate",
        "Strontium titanate",
        "Fabulite: nearly diamond's index, more than four times its dispersion.",
        Sellmeier(((3.042143, 0.1475902), (1.170065, 0.2953086), (30.83326, 33.18606))),
        "Data of W. L. Bond, J. Appl. Phys. 36, 1674 (1965); formula by M. J. Dodge, Handbook of Laser Science and "
        "Technology IV (1986)",
        (430, 3800),
    ),
    Material(
        "rutile",
        "Rutile",
        "Titanium dioxide: the most fire of all; its very strong double refraction is not traced.",
        SinglePole(5.913, 0.2441, 0.0803),
        "J. R. Devore, J. Opt. Soc. Am. 41, 416 (1951)",
        (430, 1530),
        ray="ordinary ray",
    ),
    Material(
        "bk7",
        "Glass",
        "The most common optical glass.",
        Sellmeier.of_squares((1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)),
        "SCHOTT, data sheet of N-BK7",
        (300, 2500),
    ),
    Material(
        "classic",
        "The report's",
        "The report's indices, which exaggerate the fire.",
        ThroughLines(RGB_NANOMETRES, CLASSIC_INDICES),
        "Set by the report's author; Cauchy's n = a + b / l^2 between the lines of the channels",
        (RGB_NANOMETRES[2], RGB_NANOMETRES[0]),
        confidence="as set",
    ),
)

MATERIALS: Mapping[str, Material] = MappingProxyType({material.name: material for material in _ALL})
"""By name."""


def material_of(setting: str | IndexMaterial | SellmeierMaterial) -> Material:
    """The material that a scene's `material` asks for; SceneError for a name that is not in MATERIALS."""
    if isinstance(setting, IndexMaterial):
        return Material(
            "ior",
            "Three indices",
            "Three indices of refraction.",
            ThroughLines(RGB_NANOMETRES, setting.ior),
            "Set by the scene; Cauchy's n = a + b / l^2 between the lines of the channels",
            (RGB_NANOMETRES[2], RGB_NANOMETRES[0]),
            confidence="as set",
            field="stones.0.material.ior",
        )
    if isinstance(setting, SellmeierMaterial):
        return Material(
            "sellmeier",
            "A formula",
            "A Sellmeier formula.",
            Sellmeier(setting.sellmeier),
            "Set by the scene",
            VISIBLE_NANOMETRES,
            confidence="as set",
            field="stones.0.material.sellmeier",
        )
    if setting not in MATERIALS:
        names = ", ".join(MATERIALS)
        raise SceneError(f"stones.0.material: expected one of {names}, got {setting!r}", "stones.0.material")
    return MATERIALS[setting]
