"""`sendworthy why`: why the last samples of a stream were sent or dropped."""

import argparse
import json
import shutil
import sys
import time
from collections.abc import Iterable, Iterator
from typing import Any

from proxy import clock, exit_codes
from proxy.commands.client import Client, NoAnswerError, add_client_flags, connected
from proxy.decisions_text import again, described, headed
from proxy.printable import clean
from proxy.quantities import duration
from proxy.why import LAST, Question, QuestionError

DESCRIPTION = """\
Tells the last decisions on the samples of KEY that the daemon here made, and why: what a sample competed with, what the
team gains by the best plan with and without it, what its room costs and what it earns, which limit is scarce, and how
sure the planner was. All worths and gains are utility by the specs. In shadow it tells what would have been dropped.

KEY is the key of a stream, a part of it that no other one has, or a key expression such as 'robot/*/camera'. The
daemon always keeps the last 16 decisions on each stream, so nothing need be switched on before; samples of which the
same became for the same reason are one decision. Each robot decides on its own samples, where specs plan for them.

What a sample is worth, and how that comes about, `sendworthy explain KEY` tells.
"""
EXAMPLES = """\
examples:
  sendworthy why robot/r1/camera
  sendworthy why camera --last 1
  sendworthy why 'robot/*/camera' --follow
  sendworthy why camera --last 16 --json | jq '.streams[].decisions[] | {reason, age, size}'

With --json the answer has a `version`, the `streams` that are meant, and of each the `decisions`, the oldest first;
with --follow each line is one decision. proxy/WHY.md describes every field. The exit code is 0 when the daemon knows
such a stream, also where nothing was decided on it yet; 1 when it does not, or no daemon answers; 2 for a wrong command
line.
"""
MOST_PAUSE, LEAST_PAUSE = 2.0, 0.1
"""The daemon is asked again after so long [s]: the less is decided on a stream, the longer..."""
AT_ONCE = LAST[1] * 3 // 4
"""... so that an answer has so many decisions at most, of those that are kept."""
NARROW, WIDE = 60, 120
"""Text is no narrower and no wider than this."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "why",
        help="say why samples were sent or dropped",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("key", metavar="KEY", help="a key, a part of one, or a key expression")
    parser.add_argument(
        "--last",
        metavar="N",
        type=int,
        default=3,
        help=f"how many decisions on each stream, at most {LAST[1]} (default: %(default)s)",
    )
    parser.add_argument("--follow", action="store_true", help="go on with what is decided from now on, until Ctrl-C")
    parser.add_argument("--json", action="store_true", help="the same as JSON; with --follow one decision a line")
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Ask and print; return the exit code."""
    try:
        question = Question(arguments.key, arguments.last)
    except QuestionError as error:
        print(f"sendworthy why: {error}", file=sys.stderr)
        return exit_codes.USAGE
    try:
        with connected(arguments.connect) as daemon, daemon.understood():
            robot = arguments.robot or daemon.only_robot()
            answer = _answer(daemon, robot, question)
            if arguments.follow:
                _follow(daemon, robot, question, answer, as_json=arguments.json)
            _print([json.dumps(answer, indent=2)] if arguments.json else map(clean, told(answer, _width())))
    except NoAnswerError as error:
        print(f"sendworthy why: {error}", file=sys.stderr)
        return exit_codes.FAILED
    return exit_codes.OK


def told(answer: dict[str, Any], width: int) -> Iterator[str]:
    """Yield an answer as text."""
    for place, stream in enumerate(answer["streams"]):
        if place:
            yield ""
        yield from headed(stream, width)
        if not stream["decisions"]:
            yield "  nothing was decided on it yet"
        for decision in stream["decisions"]:
            yield ""
            yield from described(decision, _ago(decision), width)
    if answer.get("left_out"):
        yield ""
        yield f"and {len(answer['left_out'])} more streams: {', '.join(answer['left_out'])}"


class Following:
    """What was seen of each stream; makes lines of what is new."""

    def __init__(self, *, as_json: bool) -> None:
        self._json = as_json
        self._nth: dict[str, int] = {}
        """The number of the last decision that was seen, by key."""

    def news(self, answer: dict[str, Any], width: int) -> Iterator[str]:
        """Yield what an answer has that was not seen before."""
        for stream in answer["streams"]:
            key, decisions = stream["key"], stream["decisions"]
            if key not in self._nth and not self._json:
                yield from headed(stream, width)
            for decision in decisions:
                seen = self._nth.get(key, decision["nth"] - decision["count"])
                self._nth[key] = decision["nth"]
                yield from self._new(stream, decision, seen, width)
            self._nth.setdefault(key, 0)

    def restarted(self) -> None:
        """The daemon began anew: so do its numbers."""
        self._nth.clear()

    def _new(self, stream: dict[str, Any], decision: dict[str, Any], seen: int, width: int) -> Iterator[str]:
        if self._json:
            yield json.dumps({"version": 1, "robot": stream["robot"], "key": stream["key"], **decision})
            return
        when = time.strftime("%H:%M:%S", time.localtime(clock.wall() - decision["age"]))
        more, missed = decision["nth"] - seen, decision["nth"] - decision["count"] - seen
        if missed < 0:
            yield from again(decision, more, f"{when} {stream['key']}", width)
            return
        if missed:
            yield f"({missed} decisions on {stream['key']} in between came too fast to be shown)"
        yield ""
        yield from described(decision, f"{when} {stream['key']}", width)


def _answer(daemon: Client, robot: str, question: Question) -> dict[str, Any]:
    """Ask. Raises NoAnswerError, also where the daemon knows no such stream."""
    answer = daemon.why(robot, question)
    if answer.get("problem"):
        raise NoAnswerError(f"robot {robot}: {answer['problem']}")
    return answer


def _follow(daemon: Client, robot: str, question: Question, answer: dict[str, Any], *, as_json: bool) -> None:
    """Print what is decided, until somebody stops us. Raises NoAnswerError when the daemon goes away."""
    following, after, wait = Following(as_json=as_json), 0, LEAST_PAUSE
    while True:
        if answer["decided"] < after:
            following.restarted()
        after = answer["decided"]
        _print(map(clean, following.news(answer, _width())))
        wait = pause(answer, wait)
        time.sleep(wait)
        answer = _answer(daemon, robot, Question(question.key, LAST[1], after))


def pause(answer: dict[str, Any], last: float) -> float:
    """Return how long to wait until the next question, after waiting `last` for this answer [s].

    So no decision is missed, and few questions are in vain.
    """
    most = max((len(stream["decisions"]) for stream in answer["streams"]), default=0)
    return min(MOST_PAUSE, max(LEAST_PAUSE, last * AT_ONCE / max(most, 1)))


def _ago(decision: dict[str, Any]) -> str:
    last = f"{duration(max(0.0, decision['age']))} ago"
    return f"{duration(decision['first_age'])} to {last}" if decision["count"] > 1 else last


def _width() -> int:
    return min(max(shutil.get_terminal_size().columns, NARROW), WIDE)


def _print(lines: Iterable[str]) -> None:
    for line in lines:
        print(line, flush=True)
