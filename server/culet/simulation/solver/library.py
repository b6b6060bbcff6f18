"""The compiled solver, found or made, loaded once a process."""

from __future__ import annotations

import ctypes
import logging
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

from culet.errors import SolverUnavailableError
from culet.simulation.solver.build import SOURCES, BuildError, build, library_name
from culet.simulation.solver.interface import VERSION, declare

log = logging.getLogger(__name__)


def cache_folder() -> Path:
    """Where a library is kept that came with no installation: in the user's cache, as what PoCL compiles."""
    return user_cache_path("culet") / "solver"


@cache
def library() -> ctypes.CDLL:
    """The library of these sources: the installed one, else that of the cache, else it is compiled, in some seconds.

    SolverUnavailableError says what is missing.
    """
    name = library_name()
    for folder in (SOURCES, cache_folder()):
        if (folder / name).is_file():
            return loaded(folder / name)
    try:
        made = build(cache_folder())
    except BuildError as error:
        raise SolverUnavailableError(f"stones are moved by a compiled solver, and there is none: {error}") from None
    except OSError as error:
        raise SolverUnavailableError(
            f"stones are moved by a compiled solver, which cannot be kept in {cache_folder()} "
            f"({error.strerror}); name another folder by XDG_CACHE_HOME"
        ) from error
    log.info("compiled the solver of stones in contact: %s", made)
    return loaded(made)


def loaded(file: Path) -> ctypes.CDLL:
    """That file, its functions declared. SolverUnavailableError if it cannot be loaded."""
    try:
        library = ctypes.CDLL(str(file))
    except OSError as error:
        raise SolverUnavailableError(
            f"the compiled solver {file} cannot be loaded ({error}); remove the file, so that it is compiled anew"
        ) from error
    declare(library)
    found = library.culet_interface()
    if found != VERSION:
        raise SolverUnavailableError(f"the compiled solver {file} has interface {found}; expected {VERSION}")
    return library
