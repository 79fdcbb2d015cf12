"""The metrics as Prometheus reads them, off the totals of the status when it asks: between two scrapes nothing is done.

They are written here, as the lines differ in their values only: Prometheus' library takes three times as long.
Source: the text format 0.0.4 of Prometheus.
"""

import math
import threading
from collections.abc import Callable, Iterator

from proxy import clock
from proxy.metrics.exported import METRICS
from proxy.metrics.metric import Metric, Status
from proxy.metrics.process import ProcessMetrics

FRESH = 0.2
"""The status is read this often at most [s], however many ask: it is read between two decisions."""
NAMES = 4096
"""So many names with their labels are remembered; a daemon has some hundred, and new ones when specs change."""
_ESCAPED = str.maketrans({"\\": r"\\", "\n": r"\n", '"': r"\""})


class Exposition:
    """Writes what `read` returns, which may raise TimeoutError. From any thread."""

    def __init__(self, read: Callable[[], Status]) -> None:
        self._read = read
        self._lock = threading.Lock()
        self._read_at = -math.inf
        self._text = b""
        self._process = ProcessMetrics()
        self._names: dict[tuple[str, ...], str] = {}

    def text(self) -> bytes:
        """Return every metric that has a value, those of the process before ours."""
        with self._lock:
            if clock.monotonic() >= self._read_at + FRESH:
                status = self._read()
                self._text = (self._process.text() + "".join(self._lines(status))).encode()
                self._read_at = clock.monotonic()
            return self._text

    def _lines(self, status: Status) -> Iterator[str]:
        robot = str(status["robot"])
        for metric in METRICS:
            rows = dict(metric.rows(status))  # where two robots have one name the one that was met last is meant
            if rows:
                yield metric.head
            for labels, value in rows.items():
                yield f"{self._name(metric, robot, labels)} {_number(value)}\n"

    def _name(self, metric: Metric, robot: str, labels: tuple[str, ...]) -> str:
        """Return what a line begins with."""
        found = self._names.get((metric.name, robot, *labels))
        if found is None:
            if len(self._names) >= NAMES:
                self._names.clear()
            pairs = zip(("robot", *metric.labels), (robot, *labels), strict=True)
            told = ",".join(f'{name}="{value.translate(_ESCAPED)}"' for name, value in pairs)
            found = self._names[metric.name, robot, *labels] = f"{metric.exported}{{{told}}}"
        return found


def _number(value: float) -> str:
    return repr(float(value)) if math.isfinite(value) else {math.inf: "+Inf", -math.inf: "-Inf"}.get(value, "NaN")
