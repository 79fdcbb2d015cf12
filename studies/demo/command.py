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

from studies.demo.events import Event, write_events
from studies.demo.figures import figures
from studies.demo.mosaic import draw, moment
from studies.demo.nodes import DOWNSAMPLED, PHASES, WITH, WITHOUT
from studies.demo.phase import Conditions, Progress, run_phase
from studies.demo.processes import DemoError
from studies.demo.recording import recordings
from studies.demo.scene import schedule
from studies.demo.table import table

DESCRIPTION = """\
Robots film, a medium that is too small carries, an operator watches: first with stock Zenoh routers, then with
Zenoh's own downsampling, tuned to the limit, then with our daemon on every robot. All runs on this machine and
needs no rights. It takes about three times --seconds.
"""
EXAMPLES = """\
examples:
  sendworthy demo
  sendworthy demo --robots 6 --rate 4e6 --seconds 60
  sendworthy demo --json demo.json --events demo.jsonl && python -m studies.demo.figures demo.jsonl
"""
FAILED = 1
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
    parser.add_argument("--robots", metavar="N", type=_robots, default=4, help="how many (default: 4)")
    parser.add_argument("--seconds", metavar="S", type=_seconds, default=30.0, help="length of each run (default: 30)")
    parser.add_argument(
        "--rate", metavar="BIT/S", type=_rate, default=3e6, help="what the medium carries (default: 3e6)"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=1, help="of the scene (default: 1)")
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
    episodes = schedule(arguments.seed, arguments.robots, arguments.seconds)
    at = moment(episodes, arguments.seconds)
    conditions = Conditions(arguments.robots, arguments.seconds, arguments.rate, arguments.seed, at)
    with tempfile.TemporaryDirectory(prefix="sendworthy-demo-") as name, _interruptible():
        folders = {phase: Path(name) / phase for phase in PHASES}
        events: list[Event] = []
        try:
            for phase, folder in folders.items():
                folder.mkdir()
                print(_announcement(phase, conditions), flush=True)
                events += run_phase(phase, conditions, folder, _show, events)
                _end_line()
            _report(arguments, events, folders, at)
        except (DemoError, OSError) as error:
            print(f"sendworthy demo: {error}", file=sys.stderr)
            return FAILED
    return 0


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
    if number not in range(1, 51):
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1 to 50")
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
