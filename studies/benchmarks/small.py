"""What a small computer makes of it: a daemon that may take a quarter of a core decides on the images of four cameras.

That a quarter of this core is a Raspberry Pi 4 is an assumption. Needs root, for the kernel holds the daemon to it.
"""

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from studies.benchmarks.budget import MEGABYTE
from studies.benchmarks.report import Table
from studies.benchmarks.resources import processor_time, resident_memory
from studies.demo.air import Air
from studies.demo.layout import Node, lay_out
from studies.demo.nodes import SURVEILLANCE, WINDOW, start_daemons, status
from studies.demo.processes import Process, Troupe
from studies.demo.staging import PATIENCE, start_app, start_medium
from studies.surveillance.cores import held_to

PART = 0.25
"""Of a core: what is taken for one of a Raspberry Pi 4."""
CAMERAS = 4
"""Of the robot, ten frames a second each."""
MEDIUM = 100e6
"""What the medium carries [bit/s]: nothing waits there."""
LIMIT = 3e6
"""What the spec allows [bit/s]: a quarter of what the cameras offer."""
LEAD = 1.0
"""The cameras are told the start time this long ahead [s]."""
SETTLING = 3.0
"""What is measured begins so long after the first frame: streams are known then [s]."""
DAY = 86_400.0
PROFILE = Path(__file__).parents[2] / "deploy" / "raspberry-pi.toml"


@dataclass(frozen=True, slots=True)
class Load:
    """What a daemon took in `seconds`: of a whole `core`, `resident` memory [B], and its log, as it would grow [B/day].

    `before` and `after` are its statuses around that.
    """

    seconds: float
    core: float
    resident: int
    logged: float
    before: dict[str, Any]
    after: dict[str, Any]

    def more(self, table: str, name: str) -> float:
        """Return by how much what a table of the status says has grown."""
        return float(self.after[table][name]) - float(self.before[table][name])

    def untimely(self) -> int:
        """Return how many samples went, or not, without a decision of their own that was in time."""
        before, after = (status["counts"]["by_reason"] for status in (self.before, self.after))
        grown = {reason: count - before.get(reason, 0) for reason, count in after.items()}
        return sum(count for reason, count in grown.items() if reason.endswith(("fallback", "overflow")))

    def row(self, title: str, part: float) -> tuple[str, ...]:
        """Return the cells of the table."""
        made = self.more("decisions", "made")
        mean = f"{1e3 * self.more('decisions', 'seconds') / made:.2f}" if made else "–"
        return (
            title,
            f"{self.core / part:.0%}",
            f"{self.more('counts', 'in') / self.seconds:.1f}",
            f"{made:.0f}",
            f"{self.more('decisions', 'late'):.0f}",
            str(self.untimely()),
            mean,
            f"{1e3 * self.after['decisions']['longest']:.1f}",
            f"{self.resident / MEGABYTE:.0f}",
            f"{self.logged / MEGABYTE:.1f}",
        )


def measure_small(*, quick: bool) -> list[Table]:
    """Fly as the daemon comes and with the shipped profile; `quick` takes some seconds. Raises CoresError."""
    seconds = 4.0 if quick else 60.0
    cases: list[tuple[str, float, Path | None]] = [
        ("a whole core", 1.0, None),
        ("a quarter of a core", PART, None),
        (f"the same, {PROFILE.name}", PART, PROFILE),
    ]
    rows = tuple(fly(part, seconds, profile).row(title, part) for title, part, profile in cases)
    note = (
        f"{CAMERAS} cameras of 640 x 480 at 10 Hz on one robot, whose images the daemon looks into for red, and room"
        f" for a quarter of them; {seconds:g} s. A quarter of this machine's core stands for one of a Raspberry Pi 4:"
        " that is an assumption. *Of it* is what the daemon took of such a core. Late are searches after their"
        " deadline; by fallback, or for want of a place to wait, went samples that had no decision in time. A search"
        " took the mean, and the longest [ms]; memory is resident [MB]; the log would grow by so much a day [MB]."
    )
    columns = ("the daemon has", "of it", "samples/s", "searches", "late", "fallback", "mean", "longest", "MB", "log")
    return [Table("A daemon on a small computer", columns, rows, note)]


def fly(part: float, seconds: float, profile: Path | None) -> Load:
    """Fly a robot's daemon that may take this part of a core, with what `profile` lays upon its configuration."""
    nodes = lay_out(1)
    robot = nodes[1]
    with TemporaryDirectory(prefix="sendworthy-small-") as name, ExitStack() as stack:
        folder = Path(name)
        if profile is not None:
            (folder / "conf.d").mkdir()
            (folder / "conf.d" / profile.name).write_text(profile.read_text())
        troupe = stack.enter_context(Troupe(folder))
        _, dials = start_medium(troupe, nodes, Air(MEDIUM / 8), None)
        daemons = start_daemons(troupe, nodes, dials, SURVEILLANCE.format(limit=LIMIT, window=WINDOW), folder)
        daemon = daemons[1]
        if part < 1.0:
            stack.enter_context(held_to(part, [daemon.pid]))
        operator = start_app(troupe, "operator", nodes[0], folder, ["--photograph-at", "1e9", "--photographs", name])
        apps = [operator, *_cameras(troupe, robot, SETTLING + seconds + LEAD)]
        for app in apps:
            app.hear(PATIENCE)
        start = time.monotonic() + LEAD
        for app in apps:
            app.tell(start)
        time.sleep(max(0.0, start + SETTLING - time.monotonic()))
        log = folder / f"{daemon.name}.err"
        before, spent, logged, began = status(robot), processor_time(daemon.pid), log.stat().st_size, time.monotonic()
        time.sleep(seconds)
        troupe.check()
        spent, passed = processor_time(daemon.pid) - spent, time.monotonic() - began
        logged = log.stat().st_size - logged
        resident = resident_memory(daemon.pid)
        return Load(passed, spent / passed, resident, logged / passed * DAY, before, status(robot))


def _cameras(troupe: Troupe, robot: Node, seconds: float) -> Sequence[Process]:
    common = ("--robots", str(CAMERAS), "--seconds", str(seconds), "--seed", "1", "--connect", robot.app_endpoint)
    return [
        troupe.start(f"camera-{number}", "-m", "studies.demo.camera", "--robot", str(number), *common)
        for number in range(CAMERAS)
    ]
