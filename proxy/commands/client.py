"""Asking a running daemon, over Zenoh, as one of its robot's applications."""

import argparse
import json
import os
import sys
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

import zenoh

from proxy import clock, exit_codes
from proxy.bridge import keys
from proxy.bridge.control import LIVE
from proxy.bridge.fleet import CHALLENGE, Outcome, challenges, read_outcomes
from proxy.bridge.tuning import TUNING
from proxy.commands.credentials import Credentials, of_environment
from proxy.config_values import endpoint, robot_name
from proxy.errors import ProxyError
from proxy.fleet_token import proofs, read_token, token_of
from proxy.printable import clean
from proxy.profiling.profile import Profile, read
from proxy.profiling.request import END, Request
from proxy.status.shape import fits
from proxy.why import Question

DAEMON = "tcp/127.0.0.1:7447"
TOKEN = "SENDWORTHY_FLEET__TOKEN"  # noqa: S105 - the name of the variable
"""The variable with the team's token, as the daemon reads it."""
TIMEOUT = 2.0
"""A daemon answers within this time [s] or not at all."""


class NoAnswerError(ProxyError):
    """No daemon answers, or not one alone."""


def add_client_flags(parser: argparse.ArgumentParser) -> None:
    """Add the flags of every command that asks a daemon."""
    parser.add_argument(
        "--connect",
        metavar="ENDPOINT",
        type=endpoint_flag,
        default=DAEMON,
        help="where the daemon listens for applications (default: %(default)s)",
    )
    parser.add_argument(
        "--robot",
        metavar="NAME",
        type=robot_flag,
        help="the robot whose daemon is meant, should several answer",
    )


def add_token_flag(parser: argparse.ArgumentParser) -> None:
    """Add the flag of commands that give orders to all robots."""
    parser.add_argument(
        "--token-file",
        metavar="FILE",
        type=_token_in,
        dest="token",
        help=f"prove by the token in this file that the order is the team's own (default: the token in {TOKEN})",
    )


def _token_in(text: str) -> str:
    try:
        return read_token(Path(text))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def given_token(arguments: argparse.Namespace) -> str:
    """Return the token of the flag or of the environment; nothing where neither has one. Raises NoAnswerError."""
    if arguments.token is not None or not os.environ.get(TOKEN):
        return arguments.token or ""
    try:
        return token_of(os.environ[TOKEN])
    except ValueError as error:
        raise NoAnswerError(f"{TOKEN}: {error}") from None


def endpoint_flag(text: str) -> str:
    """Read an endpoint for argparse."""
    try:
        return endpoint(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def robot_flag(text: str) -> str:
    """Read a robot's name for argparse."""
    try:
        return robot_name(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


class Client:
    """A session with the daemon at `where`."""

    def __init__(self, session: zenoh.Session, where: str) -> None:
        self._session = session
        self._where = where

    def status(self, robot: str | None, *, live: bool = False) -> list[dict[str, object]]:
        """Return the status of `robot`, or of all that answer, by name. Raises NoAnswerError.

        `live`: of streams only what changes with each sample; a daemon that does not know that tells all.
        """
        answers = self._ask(keys.status(robot or "*"), LIVE if live else None)
        with self.understood():
            return sorted(map(_status, answers), key=lambda status: str(status["robot"]))

    def why(self, robot: str, question: Question) -> dict[str, Any]:
        """Return what the daemon of `robot` knows of its last decisions. Raises NoAnswerError."""
        answers = self._ask(keys.why(robot), question.write())
        if len(answers) > 1:
            raise NoAnswerError(f"{len(answers)} daemons called {robot} answer at {self._where}; rename one of them")
        with self.understood():
            answer: dict[str, Any] = parsed(answers[0])
            if not isinstance(answer["streams"], list):
                raise TypeError(answer["streams"])
            return answer

    def switch(self, robot: str, mode: str) -> None:
        """Switch `robot` to `mode`. Raises NoAnswerError."""
        if self._ask(keys.mode(robot), mode)[0] != mode:
            raise self._stranger()

    def specs(self, robot: str) -> tuple[str, dict[str, str]]:
        """Return the generation of the specs in force at `robot`, and their files by name. Raises NoAnswerError."""
        answers = self._ask(keys.specs(robot), None)
        with self.understood():
            told = parsed(answers[0])
            return str(told["generation"]), {str(name): str(text) for name, text in told["files"].items()}

    def profile(self, robot: str, request: Request) -> Profile:
        """Have the daemon of `robot` profiled, until Ctrl-C at most; return the profile. Raises NoAnswerError."""
        try:
            (answer, *_) = self._ask(keys.profile(robot), request.write(), request.seconds)
        except KeyboardInterrupt:
            (answer, *_) = self._ask(keys.profile(robot), END)
        with self.understood():
            return read(parsed(answer))

    def record(self, robot: str, told: dict[str, object]) -> dict[str, Any]:
        """Have `robot` record, or not, as `told`; return what it says of that. Raises NoAnswerError."""
        answer = self._ask(keys.record(robot), json.dumps(told))[0]
        with self.understood():
            found: dict[str, Any] = parsed(answer)
            return found

    def ask(self, key: str, payload: bytes | None = None) -> str:
        """Return what is answered on a key that is none of a daemon's own. Raises NoAnswerError."""
        return self._ask(key, payload)[0]

    def order(self, robot: str, order: str, payload: bytes, token: str = "") -> list[Outcome]:
        """Have `robot` pass an order on to all robots; return what became of it at each. Raises NoAnswerError.

        With a `token` the order is proved to those that ask for it. The token itself goes nowhere.
        """
        attachment = None
        if token:
            with suppress(NoAnswerError):  # of an older version, which passes no proofs on
                attachment = proofs(token, order, payload, challenges(self._ordered(robot, CHALLENGE, b"?")))
        return self._ordered(robot, order, payload, attachment)

    def _ordered(self, robot: str, order: str, payload: bytes, attachment: bytes | None = None) -> list[Outcome]:
        """Return what became of an order: at the robot that passes it on at least. Raises NoAnswerError."""
        asked = self._ask(keys.to_fleet(robot, order), payload, TUNING.order_wait, attachment)
        if not (outcomes := read_outcomes(asked[0].encode())):
            raise self._stranger()
        return outcomes

    def samples(self, key: str, timeout: float) -> Generator[zenoh.Sample, None, None]:
        """Yield what is put under a key expression from now on. Raises NoAnswerError after so many seconds."""
        taken: SimpleQueue[zenoh.Sample] = SimpleQueue()
        end = clock.monotonic() + timeout
        with self._session.declare_subscriber(key, zenoh.handlers.Callback(taken.put, indirect=False)):
            while True:
                try:
                    sample = taken.get(timeout=min(max(0.0, end - clock.monotonic()), threading.TIMEOUT_MAX))
                except Empty:
                    raise NoAnswerError(f"no sample of {key} came within {timeout:g} s at {self._where}") from None
                if sample.kind == zenoh.SampleKind.PUT:
                    yield sample

    def only_robot(self) -> str:
        """Return the name of the one robot whose daemon answers. Raises NoAnswerError."""
        robots = [str(status["robot"]) for status in self.status(None)]
        if len(robots) > 1:
            raise NoAnswerError(f"several daemons answer at {self._where}: choose with --robot {'|'.join(robots)}")
        return robots[0]

    @contextmanager
    def understood(self) -> Iterator[None]:
        """Take what was answered for what a daemon says. Raises NoAnswerError where it is not of that shape.

        Any application may answer in a daemon's place, anything, and a daemon of another version something else.
        """
        try:
            yield
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            raise self._stranger() from None

    def _stranger(self) -> NoAnswerError:
        return NoAnswerError(f"what answers at {self._where} is no daemon of this version")

    @contextmanager
    def listening(self, expressions: Sequence[str], take: Callable[[zenoh.Sample], object]) -> Iterator[None]:
        """Have `take` called with every sample on keys of these expressions, on threads of Zenoh, for a while."""
        handler = zenoh.handlers.Callback(take, indirect=False)
        subscribers = [self._session.declare_subscriber(each, handler) for each in expressions]
        try:
            yield
        finally:
            for subscriber in subscribers:
                subscriber.undeclare()  # type: ignore[no-untyped-call]

    def _ask(
        self, key: str, payload: str | bytes | None, longer: float = 0.0, attachment: bytes | None = None
    ) -> list[str]:
        """Return what is answered in time; what is asked may take `longer` than to answer [s]. Raises NoAnswerError."""
        replies = self._session.get(
            key,
            payload=payload,
            attachment=attachment,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=TIMEOUT + longer,
        )
        answers, late = [], ""
        for reply in replies:
            if reply.ok is not None:
                answers.append(_text(reply.ok.payload))
            else:
                late = _late(reply.err, TIMEOUT + longer)
        if not answers:
            raise NoAnswerError(f"{self._nobody(key, late=bool(late))} answers at {self._where}{late}")
        return answers

    def _nobody(self, key: str, *, late: bool) -> str:
        """Say who does not answer on a key. Raises NoAnswerError where a daemon does not know what it is asked."""
        if not key.startswith(f"{keys.PREFIX}/"):
            return "nobody"
        robot = key.split("/")[1]
        if robot == "*":
            return "no daemon"
        if not late and key != keys.status(robot) and self.status(robot):
            raise NoAnswerError(f'the daemon of robot "{robot}" at {self._where} is of a version that cannot do that')
        return f'no daemon of robot "{robot}"'


def parsed(answer: str) -> Any:
    """Return what an answer says in JSON. Raises ValueError."""
    try:
        return json.loads(answer)
    except RecursionError:
        raise ValueError("brackets in brackets") from None


def _text(payload: zenoh.ZBytes) -> str:
    """Return the text that somebody sent, whatever it is."""
    return payload.to_bytes().decode(errors="replace")


def _late(error: zenoh.ReplyError | None, timeout: float) -> str:
    """Word a time-out [s], which Zenoh tells like a refusal. Raises NoAnswerError for a real refusal."""
    refusal = _text(error.payload) if error else "no reason given"
    if refusal != "Timeout":
        raise NoAnswerError(f"the daemon refuses: {refusal}")
    return f" within {timeout:g} s"


def ordered(name: str, arguments: argparse.Namespace, order: str, payload: bytes) -> int:
    """Order all robots, for the command `name`; print what became of it, and return the exit code."""
    try:
        with connected(arguments.connect) as daemon:
            outcomes = daemon.order(arguments.robot or daemon.only_robot(), order, payload, given_token(arguments))
    except NoAnswerError as error:
        print(f"sendworthy {name}: {error}", file=sys.stderr)
        return exit_codes.FAILED
    for outcome in outcomes:
        for line in outcome.said:
            print(clean(f"{outcome.robot}: {line}"), file=sys.stdout if outcome.obeyed else sys.stderr)
    return exit_codes.OK if all(outcome.obeyed for outcome in outcomes) else exit_codes.FAILED


def _status(answer: str) -> dict[str, object]:
    """Read a status, of whose streams there may be rows under columns. Raises ValueError, TypeError or KeyError."""
    status: dict[str, Any] = parsed(answer)
    if isinstance(status, dict) and isinstance(streams := status.get("streams"), dict):
        status["streams"] = [dict(zip(streams["columns"], row, strict=True)) for row in streams["rows"]]
    if not fits(status):
        raise ValueError("no status")
    return status


@contextmanager
def connected(where: str, own: Credentials | None = None) -> Iterator[Client]:
    """Connect to the daemon at `where`, with the credentials of applications unless there are `own`.

    Raises NoAnswerError.
    """
    credentials, wrong = of_environment() if own is None else (own, "")
    config = zenoh.Config()
    for key, text in credentials.items():
        config.insert_json5(key, text)
    for key, value in {
        "mode": "client",
        "connect/endpoints": [where],
        "scouting/multicast/enabled": False,
        "transport/unicast/open_timeout": int(TIMEOUT * 1000),
    }.items():
        config.insert_json5(key, json.dumps(value))
    try:
        session = zenoh.open(config)
    except zenoh.ZError:
        # Zenoh's own text is the trace of an internal error.
        running = f"no daemon answers at {where}; is `sendworthy run` running?"
        raise NoAnswerError(f"{running} ({wrong})" if wrong else running) from None
    with session:
        yield Client(session, where)
