"""The page of the surveillance mission: what was flown, in tables and pictures."""

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np

from planner import Aggregation
from studies.benchmarks.report import Table, machine
from studies.demo.events import Publish
from studies.demo.figures import Figures, figures
from studies.demo.mosaic import draw
from studies.demo.nodes import DOWNSAMPLED, RANDOM, WITH, WITHOUT
from studies.demo.optimum import problem_of
from studies.demo.recording import Recording, recordings
from studies.study.characteristic import Characteristic, at_random
from studies.study.drawing import one_axes
from studies.study.figures import draw_characteristic
from studies.surveillance.delays import LIMIT, MEDIUM, Delay
from studies.surveillance.flying import SEED, WAYS, Flight, Mission

NAMES = {WITHOUT: "stock routers", DOWNSAMPLED: "downsampled", RANDOM: "at random", WITH: "Sendworthy"}
WANTED = {Mission(8, 6e6): 90.0, Mission(4, 3e6): 95.0}
"""Of these missions we want so much of the optimum's utility [%], and more."""
WIDE = 2400
"""Width of the picture of the screens [pixels]."""
COLUMNS: tuple[tuple[str, Callable[[Figures], float | None], str], ...] = (
    ("frames/s red", lambda f: f["fps_red"], ".2f"),
    ("other", lambda f: f["fps_other"], ".2f"),
    ("age p50 [s]", lambda f: f["age_p50_other"], ".2f"),
    ("p95 [s]", lambda f: f["age_p95_other"], ".2f"),
    ("age of red p95 [s]", lambda f: f["age_p95_red"], ".2f"),
    ("red seen after p95 [s]", lambda f: f["start_p95"], ".2f"),
    ("gone after p95 [s]", lambda f: f["end_p95"], ".2f"),
    ("false red [s]", lambda f: f["false_red"], ".1f"),
    ("oldest screen [s]", lambda f: f["staleness_max"], ".2f"),
    ("red : other", lambda f: f["fps_ratio"], ".2f"),
    ("utility", lambda f: _percent(f["utility_share_optimum"]), ".0f"),
)


def write_report(path: Path, flights: Sequence[Flight], delays: Sequence[Delay], now: datetime) -> None:
    """Write the page of what there is, and its pictures beside it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    found: dict[Mission, dict[str, Flight]] = {flight.mission: {} for flight in flights}
    for flight in flights:
        found[flight.mission][flight.way] = flight
    measured = {mission: _measured(ways) for mission, ways in found.items()}
    path.write_text("\n\n".join(_sections(path, found, measured, delays, now)) + "\n")


def _measured(ways: Mapping[str, Flight]) -> dict[str, Figures]:
    return figures(event for flight in ways.values() for event in flight.events)


def _sections(
    path: Path,
    found: Mapping[Mission, Mapping[str, Flight]],
    measured: Mapping[Mission, Mapping[str, Figures]],
    delays: Sequence[Delay],
    now: datetime,
) -> Iterator[str]:
    yield "# The surveillance mission (§4.3)"
    yield f"Written by `python -m studies.surveillance` on {now:%Y-%m-%d %H:%M} UTC. {machine()}."
    yield _HOW.format(seed=SEED)
    for mission, ways in found.items():
        yield _of_mission(mission, ways, measured[mission]).markdown()
    for mission in WANTED:
        if WITH in measured.get(mission, {}):
            yield _of_wanted(mission, measured[mission][WITH]).markdown()
    largest = max(found, key=lambda mission: (mission.robots, -abs(mission.rate - 6e6)), default=None)
    if largest:
        yield from _pictures(path, largest, found[largest])
    if delays:
        yield _of_delays(delays).markdown()
    yield _of_machine(found).markdown()


_HOW = """\
Robots drive through a drawn world; each has a camera (640 x 480, JPEG, ten frames a second), a battery and a
position, all apps that know of no filter, and one process between them and a shared medium, the demo's relay. All
processes share this machine. Each run takes 30 s and is of the same world (seed {seed}). *Downsampled* are stock
routers whose downsampling is tuned to what the medium carries; *at random* cameras send each frame with the
probability that fits it: both fill 95 % of the medium, where a spec's limit lets Sendworthy use 90 %. *Red* is a
frame of which 15 % or more are red. *Red seen after* is the time from the first such frame of an event to its
arrival, or that of a later one, *gone after* the same of the first frame that is not red any more; *false red* is
how long all screens together showed red where there was none. *Utility* is that of the aggregation `current`, as a
part of the offline optimum [%]."""


def _of_mission(mission: Mission, ways: Mapping[str, Flight], measured: Mapping[str, Figures]) -> Table:
    rows = []
    for way in WAYS:
        if way in ways:
            values = [(value(measured[way]), form) for _, value, form in COLUMNS]
            rows.append((NAMES[way], *("–" if value is None else format(value, form) for value, form in values)))
    some = measured[next(iter(ways))]
    offered = (some["published_bytes"] or 0.0) * 8e-6 / 30.0
    ratio = measured.get(WITH, some)["fps_ratio_optimum"]
    best = "" if ratio is None else f" The offline optimum has {ratio:.2f} red frames for each other one."
    note = f"{offered:.1f} Mbit/s offered, {some['events']} times a robot met something red.{best}"
    return Table(mission.title, ("", *(name for name, _, _ in COLUMNS)), tuple(rows), note)


def _of_wanted(mission: Mission, found: Figures) -> Table:
    """Compare what was measured with what we want."""
    ratio, best = found["fps_ratio"], found["fps_ratio_optimum"]
    off = None if ratio is None or not best else 100 * abs(ratio / best - 1)
    rows = (
        ("red seen after, p95 [s]", found["start_p95"], "≤", 0.5),
        ("red gone after, p95 [s]", found["end_p95"], "≤", 1.0),
        ("red : other", ratio, "≥", 2.0),
        ("that, off the optimum's ratio [%]", off, "≤", 15.0),
        ("oldest screen [s]", found["staleness_max"], "≤", 3.0),
        ("utility of the optimum's [%]", _percent(found["utility_share_optimum"]), "≥", WANTED[mission]),
    )
    cells = [(name, f"{sign} {wanted:g}", *_judged(value, sign, wanted)) for name, value, sign, wanted in rows]
    return Table(f"What we want of {mission.title}", ("", "wanted", "measured", "met"), tuple(cells))


def _judged(value: float | None, sign: str, wanted: float) -> tuple[str, str]:
    if value is None:
        return "–", "–"
    return f"{value:.2f}", "yes" if (value <= wanted if sign == "≤" else value >= wanted) else "**no**"


def _pictures(path: Path, mission: Mission, ways: Mapping[str, Flight]) -> Iterator[str]:
    recorded = recordings(event for flight in ways.values() for event in flight.events)
    every = Characteristic.of(at_random(problem_of(next(iter(recorded.values())), Aggregation.MOST_RECENT)))
    name = f"{path.stem}-characteristic.png"
    with one_axes(path.with_name(name)) as axes:
        draw_characteristic(axes, every)
    levels = ", ".join(f"{100 * part:.0f} % {level}" for level, part in every.levels.items())
    yield f"## The characteristic (Fig. 4)\n\n{mission.title}: of the messages {levels} utility.\n\n![{name}]({name})"
    name = f"{path.stem}-screens.jpg"
    _draw_screens(path.with_name(name), mission, ways, recorded)
    note = f"{mission.title}, the same moment of each run. A red frame: the robot sees red at that moment."
    yield f"## The operator's screens (Fig. 5)\n\n{note}\n\n![{name}]({name})"


def _draw_screens(path: Path, mission: Mission, ways: Mapping[str, Flight], recorded: Mapping[str, Recording]) -> None:
    folders = {way: ways[way].photographs for way in WAYS if way in ways}
    with tempfile.TemporaryDirectory() as name:
        draw(folders, recorded, mission.episodes_end, Path(name) / "screens.png")
        image = cv2.imread(str(Path(name) / "screens.png"))
    if image is None:
        raise OSError("the picture of the screens cannot be read")
    height = round(image.shape[0] * WIDE / image.shape[1])
    cv2.imwrite(
        str(path), cv2.resize(image, (WIDE, height), interpolation=cv2.INTER_AREA), [cv2.IMWRITE_JPEG_QUALITY, 82]
    )


def _of_delays(delays: Sequence[Delay]) -> Table:
    rows = [
        (
            each.way,
            str(each.frames),
            str(each.waited),
            *(f"{1e3 * value:.1f}" for value in (*each.sent, *each.arrived)),
            str(each.decided),
            f"{1e3 * each.seconds:.2f}" if each.decided else "–",
            f"{1e3 * each.longest:.2f}" if each.decided else "–",
        )
        for each in delays
    ]
    times = ("sent p50 [ms]", "p99", "arrived p50 [ms]", "p99")
    columns = ("", "frames", "waited", *times, "searches", "mean [ms]", "longest")
    note = (
        f"One robot and the operator on {MEDIUM / 1e6:g} Mbit/s, limited to {LIMIT / 1e6:g} Mbit/s: half of what its"
        " camera offers. Sent is the time from a frame's publication to its first byte on the medium. Frames that"
        " waited for room under the limit are told apart, and not in the times. The last columns are what the daemon"
        " says of its searches. Under a tenth of a core each daemon has that, the robot's and the operator's."
    )
    return Table("What decisions add", columns, tuple(rows), note)


def _of_machine(found: Mapping[Mission, Mapping[str, Flight]]) -> Table:
    rows = []
    for mission, ways in found.items():
        for flight in (ways[way] for way in WAYS if way in ways):
            late = np.array(_lateness(flight))
            rows.append(
                (f"{mission.title}, {NAMES[flight.way]}", f"{100 * flight.busy:.0f}", f"{flight.own:.2f}", _late(late))
            )
    note = (
        "How busy all cores were, whoever kept them so, how many of them the mission took, and how much later than ten"
        " times a second frames were published: where that is more than a few milliseconds the machine could not keep"
        " up, and figures are worse than they would be on robots that have cores of their own."
    )
    return Table(
        "How busy the machine was",
        ("", "busy [%]", "the mission's [cores]", "frames late by p99 [ms]"),
        tuple(rows),
        note,
    )


def _lateness(flight: Flight) -> list[float]:
    """Return how much later each frame came than the most punctual one of its robot would have it [s]."""
    by_robot: dict[str, list[float]] = {}
    for event in flight.events:
        if isinstance(event, Publish):
            by_robot.setdefault(event.robot, []).append(event.t - 0.1 * event.number)
    return [each - min(times) for times in by_robot.values() for each in times]


def _late(late: "np.typing.NDArray[np.float64]") -> str:
    return f"{1e3 * float(np.percentile(late, 99)):.1f}" if len(late) else "–"


def _percent(value: float | None) -> float | None:
    return None if value is None else 100 * value
