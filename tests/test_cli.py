"""The command line as a user has it: its output and its exit code, of processes where a process makes a difference."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import culet.stills as culet_stills
from command_line import Run, culet, invoke
from culet.geometry.stone_file import shape_from_file
from culet.rendering.features import RUNTIME, features_of
from culet.rendering.renderer import Renderer
from culet.scene import PRESETS
from culet.study.bench.cases import CASES, FEATURE_CASES, stage_of
from culet_protocol.watch import watch_id
from engine.peer import TETRAHEDRON, connected, running_engine
from gateway.running import announced, eventually
from geometry.designs.files import design, gcs_of
from shared.patience import PATIENCE

COMMANDS = [
    "render",
    "simulate",
    "bench",
    "serve",
    "gateway",
    "engine",
    "view",
    "record",
    "design",
    "grade",
    "sweep",
    "animate",
    "path",
]
TINY = ("--width", "48", "--height", "27")
ALL_SKY = {"stones": [], "floor": {"kind": "none"}, "backdrop": {"kind": "none"}}
"""A scene of whose sky nothing is hidden."""
MEASURED_FEATURES = tuple(FEATURE_CASES)


def refused(run: Run) -> str:
    """The one line that says why not."""
    assert run.returncode == 1
    assert "Traceback" not in run.stderr
    (line,) = run.stderr.splitlines()
    return line


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str) -> None:
    run = invoke(command, "--help")
    assert run.returncode == 0
    assert f"culet {command}" in run.stdout


def test_the_version_is_told() -> None:
    run = culet("--version")
    assert (run.returncode, run.stdout) == (0, f"culet {version('culet')}\n")


@pytest.mark.parametrize("command", ["render", "simulate"])
def test_the_help_of_a_command_names_the_presets(command: str) -> None:
    words = re.findall(r"[\w-]+", invoke(command, "--help").stdout)
    assert [name for name in PRESETS if name not in words] == []


def test_without_a_command_all_are_listed() -> None:
    shown = invoke("--help").stdout
    assert all(command in shown for command in COMMANDS)


@pytest.mark.parametrize(("ending", "format_"), [("tga", "TGA"), ("png", "PNG"), ("jpg", "JPEG")])
def test_a_rendered_picture_can_be_opened(tmp_path: Path, ending: str, format_: str) -> None:
    out = tmp_path / f"gem.{ending}"
    run = invoke("render", "-o", out, *TINY)
    assert run.returncode == 0, run.stderr
    with Image.open(out) as picture:
        assert (picture.format, picture.size) == (format_, (48, 27))
    assert [path.name for path in tmp_path.iterdir()] == [out.name]  # nothing else is left


def test_a_linear_picture_holds_radiance_not_pixels(tmp_path: Path) -> None:
    out = tmp_path / "gem.npy"
    scene = ALL_SKY | {"environment": {"kind": "constant", "radiance": [0.25, 2, 8]}}
    run = invoke("render", "-", "-o", out, *TINY, stdin=json.dumps(scene))
    assert run.returncode == 0, run.stderr
    assert np.load(out).reshape(-1, 3) == pytest.approx(np.tile([0.25, 2, 8], (48 * 27, 1)))


def test_more_samples_are_taken_when_asked_for(tmp_path: Path) -> None:
    run = invoke("render", "-o", tmp_path / "gem.png", "--samples", "3", "--preset", "matte", *TINY)
    assert "3 samples per pixel, estimated error as shown 0.0" in run.stdout
    assert "mean radiance too low by at most 0." in run.stdout
    run = invoke("render", "-o", tmp_path / "gem.png", "--samples", "1", *TINY)
    assert "1 sample per pixel, " in run.stdout


def test_a_mesh_takes_the_place_of_the_stone(tmp_path: Path) -> None:
    mesh = tmp_path / "gem.off"
    mesh.write_bytes(TETRAHEDRON)
    assert invoke("render", "-o", tmp_path / "cut.npy", *TINY).returncode == 0
    run = invoke("render", "-o", tmp_path / "mesh.npy", "--mesh", mesh, *TINY)
    assert run.returncode == 0, run.stderr
    assert not np.array_equal(np.load(tmp_path / "cut.npy"), np.load(tmp_path / "mesh.npy"))


def test_a_design_takes_the_place_of_the_stone_and_is_shown_and_converted(tmp_path: Path) -> None:
    """What was converted is the same stone to the last bit: so is its picture."""
    there, back = tmp_path / "stone.gcs", tmp_path / "stone.asc"
    there.write_bytes(gcs_of(design("13_chiral_negative_wheel")))
    run = invoke("design", "convert", there, back)
    assert (run.returncode, run.stderr) == (0, "")
    assert re.fullmatch(rf"{re.escape(str(back))}: 25 facets in 4 tiers; read back, planes are \S+ apart\n", run.stdout)
    shown = invoke("design", "show", back).stdout
    turned = "34 22 10 94 82 70 58 46"  # 48 less those of its own wheel: a .gcs has no offset, and counts one way
    for part in ("crown", "35.00", turned, "T/W", "0.6273", "made for a refractive index of 1.54"):
        assert part.lower() in shown.lower()
    steeper = tmp_path / "steeper.asc"
    assert invoke("design", "convert", back, steeper, "--crown-ratio", "1.2", "--table", "50").returncode == 0
    shown = invoke("design", "show", steeper).stdout
    assert "40.04" in shown  # tan = 1.2 tan 35 degrees
    assert "0.5000" in shown
    assert invoke("design", "diagram", back, "-o", tmp_path / "stone.svg").returncode == 0
    mesh = tmp_path / "stone.obj"
    assert invoke("design", "mesh", back, mesh).stdout.endswith(" of 25 facets\n")
    one, other = (shape_from_file(file.read_bytes(), file.suffix[1:]).planes for file in (back, mesh))
    assert np.abs(one[:, None] - other).max(axis=-1).min(axis=-1).max() < 1e-12  # measured 7e-15
    assert (tmp_path / "stone.svg").read_text().count("<polygon") > 25
    for file in (there, back):
        run = invoke("render", "-o", f"{file}.npy", "--mesh", file, *TINY)
        assert run.returncode == 0, run.stderr
        assert "25 facets in 4 tiers" in run.stderr
    pictures = [np.load(f"{file}.npy") for file in (there, back)]
    assert pictures[0] == pytest.approx(pictures[1], abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("show", "open.asc"), "open.asc: the design is open above and below"),
        (("show", "nowhere.gem"), "nowhere.gem: cannot be read"),
        (("show", "stone.obj"), "stone.obj: expected a design of type asc, gem, gcs, got 'obj'"),
        (("convert", "wrong.asc", "a.asc"), "wrong.asc: .asc: line 2: expected a distance, got 'x'"),
        (("diagram", "open.asc", "-o", "a.svg"), "open.asc: the design is open above and below"),
        (("diagram", "open.asc", "-o", "a.png"), "out: expected a name that ends in .svg"),
        (("convert", "wrong.asc", "a.asc", "--crown-ratio", "9"), "crown_ratio: expected at most 5; got 9"),
        (("convert", "open.asc", "a.gem"), "out: expected a name that ends in .asc"),
        (("convert", "open.asc", "missing/a.asc"), "there is no folder"),
    ],
)
def test_designs_that_cannot_be_used_are_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("open.asc").write_text("g 96\na 90 1 24 48 72 96\n")
    Path("wrong.asc").write_text("g 96\na 90 x 24 48 72 96\n")
    Path("stone.obj").write_text("v 0 0 0\n")
    assert said in refused(invoke("design", *arguments))
    assert not list(Path().glob("a.*"))


def test_a_search_of_a_stone_without_tiers_is_of_ratios_alone_and_says_so(tmp_path: Path) -> None:
    mesh = tmp_path / "gem.off"
    mesh.write_bytes(TETRAHEDRON)
    assert "angles: expected 0, or 0.002 to 10 degrees" in refused(
        invoke("design", "optimise", mesh, "--angles", "1e-4")
    )
    run = invoke("design", "optimise", mesh, "--evaluations", "10")
    assert "no tier can be turned by itself with all meets kept; ratios alone" in run.stderr


def test_a_mesh_takes_the_place_of_a_stone_of_any_scale(tmp_path: Path) -> None:
    mesh, scene, path = tmp_path / "gem.off", tmp_path / "small.json", tmp_path / "path.npz"
    mesh.write_bytes(TETRAHEDRON)
    scene.write_text('{"stones": [{"scale": 0.5, "position": [0, 0.5, 0]}]}')
    run = invoke("simulate", scene, "--mesh", mesh, "--seconds", "2", "-o", path)
    assert run.returncode == 0, run.stderr
    assert -1 < np.load(path)["position"][-1, 0, 1] < -0.5


@pytest.mark.parametrize(
    ("arguments", "stdin", "said"),
    [
        (["-o", "a.gif"], "", ".exr"),
        (["-o", "missing/a.png"], "", "cannot write"),
        (["-o", "."], "", "expected a name that ends in"),
        (["nowhere.json"], "", "nowhere.json: cannot be read"),
        (["-"], "{", "standard input: not JSON"),
        (["-"], "[" * 100_000, "not JSON"),
        (["-"], '{"camera": {"fov_degrees": NaN}}', "camera.fov_degrees"),
        (["-"], '{"colour": "red"}', "standard input: colour: unknown field"),
        (["-"], '{"stonez": []}', "did you mean `stones`?"),
        (["-"], '{"stones": [{"cut": {"star_percent": 1}}]}', "standard input: "),
        (["--preset", "opal"], "", "classic"),
        (["--mesh", "nowhere.obj"], "", "nowhere.obj: cannot be read"),
        (["--mesh", "/dev/null"], "", "/dev/null: "),
        (["--sky", "nowhere.exr"], "", "nowhere.exr: cannot be read"),
        (["--sky", "/dev/null"], "", "/dev/null: expected a sky as .exr, .hdr or .png"),
        (["-"], '{"environment": {"kind": "image", "image": "sunset"}}', "environment.image"),
        (["-", "--preset", "classic"], "{}", "both"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], stdin: str, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert said in refused(invoke("render", *TINY, *arguments, stdin=stdin))
    assert list(tmp_path.iterdir()) == []


def test_help_is_asked_for_in_short_too_and_names_the_exit_codes() -> None:
    assert invoke("render", "-h").stdout == invoke("render", "--help").stdout
    shown = re.sub(r"\s+", " ", invoke("-h").stdout)
    assert "Exit codes: 0 done; 1 refused, or a check that failed" in shown


@pytest.mark.parametrize(
    ("words", "completed"),
    [("culet ren", ["render"]), ("culet render --preset ru", ["ruby"]), ("culet study st", ["streaming"])],
)
def test_a_shell_completes_commands_and_presets(
    words: str, completed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("_CULET_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(words.count(" ")))
    assert invoke().stdout.split() == completed


def test_the_version_waits_for_nothing_that_commands_need() -> None:
    script = "import sys; from culet.cli import app; app(['--version'], standalone_mode=False); print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert not {"pydantic", "numpy", "zmq", "websockets", "rich"} & set(run.stdout.split())


@pytest.mark.parametrize("arguments", [["render", "--width", "0"], ["render", "--widht", "9"], ["view"], ["dance"]])
def test_wrong_usage_is_exit_code_2(arguments: list[str]) -> None:
    assert invoke(*arguments).returncode == 2


def test_a_process_ends_as_its_command_does() -> None:
    assert "nowhere.json: cannot be read" in refused(culet("render", "nowhere.json"))
    assert culet("dance").returncode == 2


@pytest.mark.parametrize(
    ("cases", "features"),
    [
        pytest.param(("default",), ("floor",), id="some"),
        pytest.param(tuple(CASES), MEASURED_FEATURES, id="all", marks=pytest.mark.soak),
    ],
)
def test_a_benchmark_prints_every_scene_and_feature_and_keeps_the_figures(
    tmp_path: Path, cases: tuple[str, ...], features: tuple[str, ...]
) -> None:
    """A scene takes a program to compile, a feature three, each twice: once to run, and once to know its size."""
    out = tmp_path / "bench.jsonl"
    with only(cases, CASES), only(features, FEATURE_CASES):
        run = invoke("bench", *TINY, "--repeats", "1", "-o", out)
        assert run.returncode == 0, run.stderr
        shown = invoke("bench", *TINY, "--repeats", "2", "--features", "-o", out, "--against", out).stdout
    assert len(re.findall(r"1\.000 +1\.000 +1\.000 *$", shown, re.MULTILINE)) == len(cases), "the same work, as exact"
    rows = {line.strip().split("  ")[0]: line.split() for line in reversed(shown.splitlines())}  # ratios come last
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert [line["width"] for line in lines] == [48, 48], "a second run is appended"
    assert lines[0]["machine"]["device"] in shown
    assert [case["name"] for case in lines[0]["cases"]] == list(cases)
    for case in lines[0]["cases"]:
        assert 0 < case["fastest"] <= case["seconds"]
        assert str(case["segments"]) in rows[case["name"]], "the same work, whatever the time"
    assert rows.keys() & set(MEASURED_FEATURES) == set(features)
    for feature in {"floor", "walls", "sky"} & set(features):
        without, idle = map(int, rows[feature][-2:])
        assert without < idle, "a program without the feature is smaller"


@pytest.mark.parametrize("name", CASES)
def test_every_scene_of_a_benchmark_renders(renderer: Renderer, name: str) -> None:
    picture = renderer.picture(stage_of(CASES[name]), 16, 9)
    picture.refine(1)
    assert np.isfinite(picture.linear()).all()
    assert (picture.segments() > 0) == (name not in ("default, 64 stones out of view", "default, without stones"))


@contextmanager
def only(names: Collection[str], among: dict[str, Any]) -> Iterator[None]:
    """There is nothing else among them, until the block ends; then all are there, in their order."""
    kept = dict(among)
    for name in kept.keys() - set(names):
        del among[name]
    try:
        yield
    finally:
        among.clear()
        among.update(kept)


@pytest.mark.parametrize("feature", MEASURED_FEATURES)
def test_of_a_benchmarks_two_scenes_one_needs_the_feature_and_the_other_does_not(feature: str) -> None:
    off, on = (features_of(stage_of(scene)) for scene in FEATURE_CASES[feature])
    assert getattr(off, feature) not in (RUNTIME, getattr(on, feature))
    assert off.without(feature) == on.without(feature), "and nothing else differs"


def test_a_sky_takes_the_place_of_the_scenes(tmp_path: Path) -> None:
    out, sky = tmp_path / "gem.npy", tmp_path / "sky.png"
    Image.new("RGB", (16, 8), (255, 0, 255)).save(sky)
    scene = ALL_SKY | {"environment": {"kind": "image", "image": "aset", "scale": 2}}
    run = invoke("render", "-", "-o", out, *TINY, "--sky", sky, stdin=json.dumps(scene))
    assert run.returncode == 0, run.stderr
    assert np.load(out).mean((0, 1)) == pytest.approx([2, 0, 2], abs=1e-6)  # measured 0; the scale is the scene's


def test_a_sky_of_odd_proportions_is_used_and_said_so(tmp_path: Path) -> None:
    sky = tmp_path / "sky.png"
    Image.new("RGB", (16, 9), (255, 0, 255)).save(sky)
    run = invoke("render", "-o", tmp_path / "gem.png", *TINY, "--sky", sky)
    assert run.returncode == 0, run.stderr
    assert run.stderr.startswith(f"{sky}: 16 x 9 pixels are stretched over all directions")


def test_stones_inside_each_other_are_drawn_and_said_so(tmp_path: Path) -> None:
    stones: list[dict[str, object]] = [{"id": "a"}, {"id": "b", "position": [1, 0, 0]}]
    run = invoke("render", "-", "-o", tmp_path / "gems.png", *TINY, stdin=json.dumps({"stones": stones}))
    assert run.returncode == 0, run.stderr
    assert run.stderr.startswith("the stones 'a' and 'b' overlap by 0.")
    apart = [stones[0], stones[1] | {"position": [3, 0, 0]}]
    run = invoke("render", "-", "-o", tmp_path / "gems.png", *TINY, stdin=json.dumps({"stones": apart}))
    assert (run.returncode, run.stderr) == (0, "")


def test_what_a_skys_file_says_of_its_numbers_is_told(tmp_path: Path) -> None:
    sky = tmp_path / "sky.hdr"
    sky.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 4 +X 8\n" + bytes([200, 150, 100, 128]) * 32)
    run = invoke("render", "-o", tmp_path / "gem.png", *TINY, "--sky", sky)
    assert run.returncode == 0, run.stderr
    assert run.stderr.startswith(f"{sky}: EXPOSURE says that the picture's radiance was multiplied by 2;")


def test_a_damaged_sky_is_refused_in_one_line_whatever_its_decoder_prints(tmp_path: Path) -> None:
    sky = tmp_path / "sky.png"
    Image.effect_noise((64, 32), 50).save(sky)
    sky.write_bytes(sky.read_bytes()[:1000])
    line = refused(culet("render", "-o", str(tmp_path / "gem.png"), "--sky", str(sky)))
    assert line.startswith(f"culet: {sky}: the .png picture is damaged or cut off")


def test_a_benchmark_that_could_not_be_kept_is_not_begun(tmp_path: Path) -> None:
    assert "cannot write" in refused(invoke("bench", "-o", tmp_path / "missing" / "bench.jsonl"))


def test_a_path_is_written_step_by_step(tmp_path: Path) -> None:
    out = tmp_path / "path.csv"
    run = culet("simulate", "--seconds", "0.5", "-o", out)
    assert run.returncode == 0, run.stderr
    header, *rows = out.read_text().splitlines()
    assert header.startswith("step,time,position_x")
    assert len(rows) == 61  # the start, and 60 steps of 1/120 s


@pytest.mark.parametrize(
    ("option", "place", "said"),
    [
        ("--plot", "missing/drop.png", "plot: cannot write missing/drop.png: there is no folder missing"),
        ("--plot", "drop.svg", "plot: expected a name that ends in .png; got 'drop.svg'"),
        ("-o", "missing/path.csv", "out: cannot write missing/path.csv: there is no folder missing"),
        ("-o", "path.txt", "out: expected a name that ends in .csv, .json, .npz; got 'path.txt'"),
    ],
)
def test_a_path_that_could_not_be_kept_is_not_simulated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, option: str, place: str, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert refused(invoke("simulate", option, place)) == f"culet: {said}"
    assert list(tmp_path.iterdir()) == []


def test_a_stone_of_another_size_has_a_path_too(tmp_path: Path) -> None:
    scene = '{"version": 2, "stones": [{"id": "large", "scale": 2, "position": [0, 4, 0]}]}'
    run = invoke("simulate", "-", "--seconds", "0.1", "-o", tmp_path / "path.csv", stdin=scene)
    assert run.returncode == 0, run.stderr
    last = (tmp_path / "path.csv").read_text().splitlines()[-1].split(",")
    assert last[:2] == ["large", "12"]
    assert float(last[4]) == pytest.approx(4 - 9.81 * 0.1**2 / 2)


def test_nothing_to_simulate_is_an_error(tmp_path: Path) -> None:
    run = invoke("simulate", "-", "-o", tmp_path / "path.csv", stdin='{"stones": []}')
    assert "needs a stone" in refused(run)


async def test_frames_of_a_session_are_taken_without_a_gateway(tmp_path: Path) -> None:
    """Each as it comes: a JPEG, or the final picture at rest, a PNG, which whoever is slow sees at once."""
    out = tmp_path / "out"
    with running_engine(tmp_path) as engine:
        async with connected(engine) as (peer, _):
            session = await peer.open({"floor": {"kind": "none"}})
            await peer.demand()
            patience = "--timeout", f"{PATIENCE:g}"
            run = culet("view", engine.frames, "--session", session, "--frames", "3", "-o", out, *patience)
            assert run.returncode == 0, run.stderr
    taken = [json.loads(line) for line in (out / "frames.jsonl").read_text().splitlines()]
    endings = [{"JPEG": "jpg", "PNG": "png"}[header["codec"]] for header in taken]
    files = [f"frame-{number:06}.{ending}" for number, ending in enumerate(endings, 1)]
    assert len(files) == 3
    assert [header["file"] for header in taken] == files
    assert sorted(path.name for path in out.iterdir()) == [*files, "frames.jsonl"]
    for header in taken:
        with Image.open(out / header["file"]) as picture:
            assert (picture.format, *picture.size) == (header["codec"], header["width"], header["height"])
    assert [header["sequence"] for header in taken] == sorted(header["sequence"] for header in taken)


def test_a_session_that_nobody_publishes_is_given_up(tmp_path: Path) -> None:
    endpoint = f"ipc://{tmp_path}/nobody"
    session = "0" * 32
    run = invoke("view", endpoint, "--session", session, "--timeout", "0.2", "-o", tmp_path / "out")
    assert f"session {session}: no frame of watch id {watch_id(session)}" in refused(run)
    run = invoke("view", endpoint, "--watch", "1" * 32, "--timeout", "0.2", "-o", tmp_path / "out")
    assert f"no frame of watch id {'1' * 32}" in refused(run)
    assert "session " not in refused(run), "only what was named is told of"
    assert "32 hexadecimal digits" in refused(invoke("view", endpoint, "--session", "x", "-o", tmp_path / "out"))


def test_an_endpoint_that_cannot_be_bound_is_said_so(tmp_path: Path) -> None:
    endpoint = f"ipc://{tmp_path}/no/such/control"
    said = refused(culet("engine", "--control", endpoint, "--frames", f"ipc://{tmp_path}/frames"))
    assert f"--control: cannot listen at '{endpoint}': there is no folder {tmp_path}/no/such; make it" in said


def test_a_folder_without_a_page_is_refused_at_once(tmp_path: Path) -> None:
    assert f"there is no {tmp_path / 'index.html'}" in refused(invoke("serve", "--port", "0", "--web", tmp_path))


async def test_serve_runs_and_ends_with_all_its_processes(tmp_path: Path) -> None:
    config, browser, shown = tmp_path / "culet.toml", tmp_path / "browser", tmp_path / "shown"
    config.write_text("port = 0\nopen = true\n")
    browser.write_text(f'#!/bin/sh\necho "$1" >{shown}\n')
    browser.chmod(0o755)
    command = [sys.executable, "-m", "culet", "serve", "--config", str(config)]
    environment = os.environ | {"BROWSER": str(browser)}
    with (
        (tmp_path / "log").open("wb") as log,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True, env=environment) as server,  # noqa: ASYNC220
    ):
        try:
            address = announced(server)

            async def opened() -> bool:
                return shown.is_file() and shown.read_text() == f"{address}\n"

            await eventually(opened)

            async def complete() -> bool:
                return len(children(server.pid)) == 4

            await eventually(complete)  # gateway and engine, and another one of each that stands by
            started = children(server.pid)
            server.send_signal(signal.SIGTERM)
            assert server.wait(PATIENCE) == 0
        finally:
            server.kill()
    assert [child for child in started if alive(child)] == []


def children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_cut_takes_the_place_of_the_stones_shape(tmp_path: Path) -> None:
    plain, oval = tmp_path / "plain.png", tmp_path / "oval.png"
    assert invoke("render", *TINY, "--samples", "1", "-o", plain).returncode == 0
    assert invoke("render", *TINY, "--samples", "1", "--cut", "oval,length_to_width=1.7", "-o", oval).returncode == 0
    assert np.abs(np.asarray(Image.open(plain), int) - np.asarray(Image.open(oval), int)).mean() > 1
    assert "cut.length_to_width: expected at least 1" in refused(
        invoke("render", *TINY, "--cut", "oval,length_to_width=0", "-o", oval)
    )
    assert "a mesh or a cut, got both" in refused(invoke("render", "--cut", "oval", "--mesh", "x.obj", "-o", oval))


def test_a_legend_that_cannot_be_is_refused_before_the_picture_is_rendered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rendered: list[object] = []
    monkeypatch.setattr(culet_stills, "render_stage", lambda *arguments, **_: rendered.append(arguments))
    out = tmp_path / "out.png"
    assert "expected an instrument's sky" in refused(invoke("render", *TINY, "--legend", "-o", out))
    assert "expected a picture of at least" in refused(invoke("render", *TINY, "--legend", "--preset=aset", "-o", out))
    assert rendered == []


def test_a_cuts_diagram_is_drawn_and_its_file_written(tmp_path: Path) -> None:
    drawing, file = tmp_path / "marquise.svg", tmp_path / "marquise.asc"
    assert invoke("design", "diagram", "marquise", "-o", drawing).returncode == 0
    assert "Marquise" in drawing.read_text()
    assert "91 facets" in invoke("design", "convert", "marquise", file).stdout
    assert "91 facets" in invoke("design", "show", file).stderr + invoke("design", "show", file).stdout
