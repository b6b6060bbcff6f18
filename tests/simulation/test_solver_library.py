"""The compiled solver: found, made by whatever compiler there is, and said to be missing in plain words."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import pytest

from culet.errors import SolverUnavailableError
from culet.simulation.solver import build, interface, library
from culet.simulation.solver.build import BuildError, compilers, library_name


def executable(folder: Path, name: str, script: str = "exit 1") -> Path:
    file = folder / name
    file.write_text(f"#!/bin/sh\n{script}\n")
    file.chmod(0o755)
    return file


def test_compilers_are_tried_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("clang-9", "clang-15", "clang-format-15", "clang", "gcc", "cc"):
        executable(tmp_path, name)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert [Path(found).name for found in compilers()] == ["cc", "gcc", "clang", "clang-15", "clang-9"]


def test_without_a_compiler_several_stones_have_a_named_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(library, "SOURCES", tmp_path)
    with pytest.raises(SolverUnavailableError, match=r"found no C compiler \(looked for cc, gcc, clang and clang-N"):
        library.library.__wrapped__()


def test_a_compiler_that_fails_is_told_with_its_own_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    executable(tmp_path, "cc", "echo 'fatal error: math.h: No such file' >&2; exit 1")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BuildError, match=r"cc: fatal error: math\.h: No such file"):
        build.build(tmp_path / "made")
    assert list((tmp_path / "made").iterdir()) == []


def test_a_cache_that_cannot_be_written_to_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "culet").write_text("a file where the folder should be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(library, "SOURCES", tmp_path)
    with pytest.raises(SolverUnavailableError, match="name another folder by XDG_CACHE_HOME"):
        library.library.__wrapped__()


def test_a_broken_library_is_told(tmp_path: Path) -> None:
    broken = tmp_path / library_name()
    broken.write_bytes(b"not a library")
    with pytest.raises(SolverUnavailableError, match="cannot be loaded"):
        library.loaded(broken)


def test_another_source_is_another_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = library_name()
    (tmp_path / "world.c").write_text("int culet;")
    monkeypatch.setattr(build, "SOURCES", tmp_path)
    assert library_name() != before


def test_the_sources_compile_without_a_warning(compiler: str) -> None:
    strict = ("-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wpedantic", "-Werror", "-fsyntax-only")
    command = [compiler, *strict, *map(str, build.SOURCES.glob("*.c"))]
    assert subprocess.run(command, capture_output=True, text=True, check=False).stderr == ""


def test_no_function_of_the_c_library_rounds_for_the_solver() -> None:
    """They differ between libraries and processors, `pow` in the last bit."""
    needed = Path(library.library()._name).read_bytes().split(b"\0")
    assert b"malloc" in needed, "names of functions stand there"
    rounding = {b"pow", b"hypot", b"exp", b"log", b"sin", b"cos", b"tan", b"asin", b"acos", b"atan2", b"fma"}
    assert not rounding & set(needed)


def test_python_knows_the_structures_as_the_header_has_them(tmp_path: Path) -> None:
    structures = {
        "CuletLaw": interface.CuletLaw, "CuletHull": interface.CuletHull, "CuletBody": interface.Properties,
        "CuletState": interface.CuletState, "CuletTouch": interface.CuletTouch,
        "CuletMotion": interface.CuletMotion, "CuletPoint": interface.CuletPoint,
    }  # fmt: skip
    sizes = "".join(f'printf("%zu ", sizeof({name}));' for name in structures)
    numbers = 'printf("%d %d %d", CULET_INTERFACE, CULET_MAX_VERTICES, CULET_MAX_SURFACES);'
    program = tmp_path / "sizes.c"
    program.write_text(f'#include <stdio.h>\n#include "culet_solver.h"\nint main(void) {{ {sizes}{numbers} }}\n')
    compiler = next(compilers())
    subprocess.run([compiler, "-I", str(build.SOURCES), str(program), "-o", str(tmp_path / "sizes")], check=True)
    told = subprocess.run([tmp_path / "sizes"], capture_output=True, text=True, check=True).stdout.split()
    expected = [*map(ctypes.sizeof, structures.values()), interface.VERSION, interface.MAX_VERTICES]
    assert [int(number) for number in told] == [*expected, interface.MAX_SURFACES]
