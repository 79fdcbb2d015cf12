"""`sendworthy demo`: the main job on real input: without the filter, with Zenoh's downsampling, and with the filter."""

import argparse
import json
import math
import signal
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from proxy.output import check_writable
from studies.demo.air import LONGEST
from studies.demo.events import Event, write_events
from studies.demo.figures import figures
from studies.demo.footage import find_footage, share
from studies.demo.live import Mission, Seen
from studies.demo.mosaic import draw, is_picture
from studies.demo.nodes import DOWNSAMPLED, PHASES, WITH, WITHOUT
from studies.demo.phase import Conditions, Progress, run_phase
from studies.demo.processes import DemoError
from studies.demo.recording import recordings
from studies.demo.table import table
from studies.demo.world import moment, schedule
from studies.given import reason_of

DESCRIPTION = """\
Robots drive through a drawn world and film, a medium that is too small carries, an operator watches who sees
something red: first with stock Zenoh routers, then with Zenoh's own downsampling, tuned to the limit, then with
our daemon on every robot. All runs on this machine and needs no rights. It takes about three times --seconds.

With --live the mission goes on, with our daemons, until Ctrl-C; other commands reach the operator's daemon
meanwhile. A query of sendworthy/demo/channel is answered with what the medium is like, {"limit": bytes a second,
"latency": seconds, "loss": 0 to 1}, and sets what it says; one of sendworthy/demo/red with {"robot": name} puts
something red into that robot's way.

--footage DIR shows what cameras film from files of your own: DIR holds a folder of images or a video for each robot,
or images that all of them replay.
"""
EXAMPLES = """\
examples:
  sendworthy demo
  sendworthy demo --robots 8 --rate 6e6 --seconds 60
  sendworthy demo --footage recordings/
  sendworthy demo --live --robots 8
  sendworthy demo --json demo.json --events demo.jsonl && python -m studies.demo.figures demo.jsonl
"""
FAILED = 1
USUAL_ROBOTS, MOST_ROBOTS = 4, 16
USUAL_RATE = 0.75e6
"""What the medium carries for each robot, a quarter of what that offers [bit/s]."""
BAR = 20
"""Width of the progress bar [characters]."""
SHORTEST = 2.0
"""A run shorter than this says nothing [s]."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "demo",
        help="show what the filter does, on this machine",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--robots",
        metavar="N",
        type=_robots,
        help=f"how many, to {MOST_ROBOTS} (default: {USUAL_ROBOTS}, or one for each footage)",
    )
    parser.add_argument(
        "--seconds", metavar="S", type=_seconds, help="length of each run (default: 30; with --live there is no end)"
    )
    parser.add_argument(
        "--rate", metavar="BIT/S", type=_rate, help="what the medium carries (default: 0.75e6 for each robot)"
    )
    parser.add_argument("--latency", metavar="S", type=_latency, default=0.0, help="of the medium (default: 0)")
    parser.add_argument(
        "--loss", metavar="PART", type=_loss, default=0.0, help="of its packets, from 0 to 1 (default: 0)"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=1, help="of the world (default: 1)")
    parser.add_argument("--footage", metavar="DIR", type=Path, help="what cameras film, in place of the drawn world")
    parser.add_argument("--live", action="store_true", help="go on until Ctrl-C, with our daemons alone")
    parser.add_argument(
        "--netns", action="store_true", help="a network namespace for each robot, and tc as the medium; needs root"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the figures here")
    parser.add_argument("--events", metavar="FILE", type=Path, help="write here what happened, event by event")
    parser.add_argument(
        "--picture",
        metavar="FILE",
        type=Path,
        default=Path("demo.png"),
        help="write the operator's screens here (default: demo.png)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the demo; return the exit code."""
    try:
        with tempfile.TemporaryDirectory(prefix="sendworthy-demo-") as name, _interruptible():
            if arguments.live:
                _live(arguments, Path(name))
            else:
                _compare(arguments, Path(name))
    except DemoError as error:
        return _failed(str(error))
    except OSError as error:
        return _failed(reason_of(error))
    return 0


def _failed(reason: str) -> int:
    print(f"sendworthy demo: {reason}", file=sys.stderr)
    return FAILED


def _compare(arguments: argparse.Namespace, folder: Path) -> None:
    """Run all phases, one after the other, and report."""
    check_writable([arguments.json, arguments.events, arguments.picture])
    if not is_picture(arguments.picture):
        raise DemoError(f"--picture {arguments.picture}: a picture is a file such as demo.png or demo.jpg")
    conditions = _conditions(arguments, arguments.seconds or 30.0)
    folders = {phase: folder / phase for phase in PHASES}
    events: list[Event] = []
    for phase, each in folders.items():
        each.mkdir()
        print(_announcement(phase, conditions), flush=True)
        events += run_phase(phase, conditions, each, _show, events)
        _end_line()
    _report(arguments, events, folders, conditions.photograph_at)


def _live(arguments: argparse.Namespace, folder: Path) -> None:
    """Go on until Ctrl-C."""
    for flag in ("json", "events"):
        if getattr(arguments, flag):
            raise DemoError(f"--{flag}: a live mission has no figures; leave out --live")
    conditions = _conditions(arguments, arguments.seconds or math.inf)
    print(f"{conditions.robots} robots behind our daemons start …", flush=True)
    with Mission(conditions, folder) as mission:
        where = mission.nodes[0].app_endpoint
        print(f"the operator's daemon is at {where}: sendworthy top --connect {where}; Ctrl-C ends it", flush=True)
        mission.run(conditions.seconds, lambda seen: _show_live(seen, mission))
    _end_line()


def _conditions(arguments: argparse.Namespace, seconds: float) -> Conditions:
    """Put together what was asked for. Raises DemoError."""
    found = find_footage(arguments.footage) if arguments.footage else []
    robots = arguments.robots or (len(found) if len(found) > 1 else USUAL_ROBOTS)
    if robots > MOST_ROBOTS:
        raise DemoError(f"--footage {arguments.footage}: {robots} robots; at most {MOST_ROBOTS}, so set --robots")
    if robots < len(found):
        print(f"of {len(found)} footages the first {robots} are shown", flush=True)
    footage = tuple(share(found[:robots], robots)) if found else ()
    finite = math.isfinite(seconds)
    at = moment(() if footage or not finite else schedule(arguments.seed, robots, seconds), seconds)
    rate = arguments.rate or USUAL_RATE * robots
    loss, latency = arguments.loss, arguments.latency
    return Conditions(robots, seconds, rate, arguments.seed, at, latency, loss, footage, arguments.netns)


def _report(arguments: argparse.Namespace, events: list[Event], folders: dict[str, Path], at: float) -> None:
    if arguments.events:
        write_events(arguments.events, events)
    draw(folders, recordings(events), at, arguments.picture)
    print("\ncomputing the figures and the offline optimum …", flush=True)
    found = figures(events)
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=2) + "\n")
    print(f"\n{table(found)}\n\nthe operator's screens: {arguments.picture}")


def _announcement(phase: str, conditions: Conditions) -> str:
    title, what = {
        WITHOUT: ("without the filter", "stock Zenoh routers"),
        DOWNSAMPLED: ("downsampled", "stock Zenoh routers that send each camera at the rate the limit has room for"),
        WITH: ("with the filter", "our daemons"),
    }[phase]
    return (
        f"{title}: {conditions.robots} robots behind {what}, {conditions.rate / 1e6:g} Mbit/s, {conditions.seconds:g} s"
    )


def _show(progress: Progress) -> None:
    done = min(round(BAR * progress.elapsed / progress.seconds), BAR)
    received = f"{progress.frames:5d} frames received, the last was {progress.age:.2f} s old"
    text = f"  [{'#' * done:.<{BAR}}] {progress.elapsed:5.1f} s {received}"
    if sys.stdout.isatty():
        print(f"\r{text}  ", end="", flush=True)
    else:
        print(text, flush=True)


def _show_live(seen: Seen, mission: Mission) -> None:
    air = mission.air
    channel = f"{8e-6 * air.limit:g} Mbit/s, {air.latency:g} s, {100 * air.loss:g} % lost"
    text = f"  {seen.elapsed:6.0f} s {seen.frames:4d} frames/s, the oldest {seen.age:.2f} s old when it came; {channel}"
    if sys.stdout.isatty():
        print(f"\r{text}  ", end="", flush=True)
    else:
        print(text, flush=True)


def _end_line() -> None:
    if sys.stdout.isatty():
        print()


@contextmanager
def _interruptible() -> Iterator[None]:
    """Let SIGTERM end the demo as Ctrl-C does, so that its processes end too."""

    def handle(_signal: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _number(text: str) -> float:
    """Read a number for argparse, whose own words for what is none name a function."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} is not a number") from None


def _robots(text: str) -> int:
    number = _number(text)
    if number not in range(1, MOST_ROBOTS + 1):
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1 to {MOST_ROBOTS}")
    return int(number)


def _seconds(text: str) -> float:
    number = _number(text)
    if not SHORTEST <= number < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not at least {SHORTEST:g}")
    return number


def _rate(text: str) -> float:
    number = _number(text)
    if not 1e5 <= number < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not at least 1e5")
    return number


def _latency(text: str) -> float:
    number = _number(text)
    if not 0.0 <= number <= LONGEST:
        raise argparse.ArgumentTypeError(f"{text} is not from 0 to {LONGEST:g}")
    return number


def _loss(text: str) -> float:
    number = _number(text)
    if not 0.0 <= number < 1.0:
        raise argparse.ArgumentTypeError(f"{text} is not from 0 to below 1")
    return number
