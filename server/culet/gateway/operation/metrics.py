"""What a gateway counts, for Prometheus. No label grows with use, as one for each session would."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from prometheus_client import CollectorRegistry, Counter, Histogram, disable_created_metrics
from prometheus_client.core import GaugeMetricFamily, HistogramMetricFamily, Metric
from prometheus_client.registry import Collector

disable_created_metrics()  # type: ignore[no-untyped-call]  # a time for each counter, which nobody asks for

ANSWER_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60)
"""Bounds of the classes that answers are counted in: from a health check to a large still."""


class Metrics:
    """Since the process began."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self._answers = Counter("culet_http_answers", "HTTP answers by status.", ["status"], registry=self.registry)
        self._answer_seconds = Histogram(
            "culet_http_answer_seconds", "Time to answer.", buckets=ANSWER_SECONDS, registry=self.registry
        )
        self._closed = Counter("culet_streams_closed", "Streams closed, by code.", ["code"], registry=self.registry)
        self._frames = Counter("culet_frames_sent", "Frames sent to viewers.", registry=self.registry)
        self._frame_bytes = Counter("culet_frame_bytes_sent", "Bytes of those frames.", registry=self.registry)

    def answered(self, status: int, seconds: float) -> None:
        """An HTTP request got its answer."""
        self._answers.labels(status).inc()
        self._answer_seconds.observe(seconds)

    def stream_closed(self, code: int) -> None:
        """A stream was closed, or refused by an HTTP status; codes of a viewer's own making are one."""
        self._closed.labels(code if code < 1016 or 4400 <= code < 4430 else "other").inc()

    def frame_sent(self, size: int) -> None:
        """A frame of that many bytes went to a viewer."""
        self._frames.inc()
        self._frame_bytes.inc(size)

    def watch(self, name: str, meaning: str, value: Callable[[], float], *, counts: bool = False) -> None:
        """Ask for a number at each scrape; `counts` if it only ever grows."""
        self.registry.register(_Asked(name, meaning, value, counts=counts))


class _Asked(Collector):
    """A number that somebody else keeps."""

    def __init__(self, name: str, meaning: str, value: Callable[[], float], *, counts: bool) -> None:
        self._name, self._meaning, self._value = name, meaning, value
        self._kind = "counter" if counts else "gauge"

    def collect(self) -> Iterable[Metric]:
        family = Metric(self._name, self._meaning, self._kind)
        family.add_sample(self._name + ("_total" if self._kind == "counter" else ""), {}, self._value())
        yield family

    def describe(self) -> Iterable[Metric]:
        """Its name, without asking."""
        yield Metric(self._name, self._meaning, self._kind)


class EngineStatus(Collector):
    """The numbers of the engine's status, as they are now; histograms are objects with `bounds`, `counts` and `sum`.

    `bounds` are upper bounds of classes, ascending; `counts` has one number for each class and one for what is above.
    """

    def __init__(self, status: Mapping[str, Any]) -> None:
        self._status = status

    def collect(self) -> Iterable[Metric]:
        for name, value in sorted(self._status.items()):
            if not name.isidentifier():
                continue
            if isinstance(value, int | float):
                yield GaugeMetricFamily(f"culet_engine_{name}", "From the engine's status.", value)
            elif isinstance(value, dict) and {"bounds", "counts", "sum"} <= value.keys():
                yield _histogram(f"culet_engine_{name}", value)


def _histogram(name: str, value: Mapping[str, Any]) -> Metric:
    below, buckets = 0, []
    for bound, count in zip([*value["bounds"], float("inf")], value["counts"], strict=True):
        below += count
        buckets.append(("+Inf" if bound == float("inf") else f"{bound:g}", below))
    return HistogramMetricFamily(name, "From the engine's status.", buckets=buckets, sum_value=value["sum"])
