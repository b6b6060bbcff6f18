"""`culet path` as a user has it."""

from __future__ import annotations

import json

import pytest

from command_line import invoke

GLASS = json.dumps(
    {"stones": [{"id": "gem", "material": "bk7", "position": [0, -0.37, 0], "orientation": [1, 0, 0, 0]}]}
)


def test_the_way_of_a_pixels_light_is_printed_with_its_shares() -> None:
    run = invoke("path", "-", "--pixel", "48,27", "--width", "96", "--height", "54", stdin=GLASS)
    assert run.returncode == 0, run.stderr
    words = " ".join(run.stdout.split())
    assert "enters by gem's" in words
    assert "% of this pixel comes from" in words
    assert "value: " in words


def test_a_ray_of_one_wavelength_is_told_as_json() -> None:
    run = invoke("path", "-", "--ray", "0,3,0.01:0,-1,0", "--wavelengths", "589.3", "--json", stdin=GLASS)
    assert run.returncode == 0, run.stderr
    path = json.loads(run.stdout)
    (chain,) = path["chains"]
    assert chain["indices"]["gem"] == pytest.approx(1.5168, abs=1e-4)  # BK7 at the sodium line
    first = path["steps"][0]
    assert first["facet_name"] == "table"
    (told,) = first["passes"]
    # Straight onto glass: Fresnel's (n - 1)^2 / (n + 1)^2.
    assert told["kept"] == pytest.approx(((1.5168 - 1) / (1.5168 + 1)) ** 2, rel=1e-3)
    assert told["incidence_degrees"] == pytest.approx(0, abs=0.05)  # a cosine of single precision


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--pixel", "640,0"], "pixel: expected x from 0 to 639"),
        (["--pixel", "1"], "pixel: expected 2 numbers with commas between them, got '1'"),
        (["--ray", "0,0,1:0,0"], "ray: expected 3 numbers"),
        (["--ray", "0,0,5:0,0,0"], "ray.direction: expected any length but 0"),
        (["--pixel", "1,1", "--ray", "0,0,5:0,0,1"], "expected a pixel or a ray, got both"),
        (["--wavelengths", "200"], "wavelengths: expected at most 16 from 380 to 780 nm, got 200"),
        (["--preset", "classic"], "optics.estimator: expected chain"),
    ],
)
def test_what_is_no_ray_is_refused_in_one_line(arguments: list[str], message: str) -> None:
    run = invoke("path", *arguments)
    assert run.returncode == 1
    (line,) = run.stderr.splitlines()
    assert message in line
