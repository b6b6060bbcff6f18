"""How many threads NumPy's linear algebra has."""

from __future__ import annotations

import os


def keep_blas_to_one_thread() -> None:
    """For a process that renders: to be called before NumPy is imported, which reads it once.

    OpenBLAS would start a thread for each core, which wait for each other by turning in circles. Beside PoCL's threads,
    one of which has each core, a product of two small matrices then takes as long as a time slice of the system. Who
    has set OPENBLAS_NUM_THREADS has his way.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
