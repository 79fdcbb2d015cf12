"""The mission that goes on until Ctrl-C (`sendworthy demo --live`), and what one may do to it meanwhile.

A queryable `sendworthy/demo/channel` tells of the medium, `{"limit": B/s, "latency": s, "loss": 0..1}`, and changes
what of that it is given; robots' limits follow. `sendworthy/demo/red` puts a red object into the way of a robot,
`{"robot": name}`. Both answer with what is so now, or with an error that says what is wrong.
"""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from itertools import count
from pathlib import Path
from threading import Lock
from typing import Self

import zenoh

from proxy.commands.client import DAEMON
from studies.demo.air import Air, AirError, read_json
from studies.demo.app import open_client, read_stamp
from studies.demo.layout import Node, lay_out
from studies.demo.namespaces import Namespaces
from studies.demo.nodes import SHARE, SURVEILLANCE, WINDOW, start_daemons, with_limit
from studies.demo.phase import LEAD, Conditions
from studies.demo.ports import is_free
from studies.demo.processes import DemoError, Process, Troupe
from studies.demo.staging import Apps, Cast, start_medium, start_robots
from studies.demo.world import Episode, schedule

CHANNEL, RED = "sendworthy/demo/channel", "sendworthy/demo/red"
LASTS = 5.0
"""How long a red object stays that somebody puts there [s]."""
AHEAD = 0.3
"""Cameras are told of an object so long before it is there: they draw ahead [s]."""
TURN = 60.0
"""Red objects come by a new schedule after each such time [s]."""
USUAL_PORT = int(DAEMON.rpartition(":")[2])


@dataclass(frozen=True, slots=True)
class Seen:
    """What the operator received in the last second: frames, and the age of the oldest of them [s]."""

    elapsed: float
    frames: int
    age: float


class Mission:
    """A mission that goes on, while in a `with` statement."""

    def __init__(self, conditions: Conditions, folder: Path) -> None:
        self.air = conditions.air
        self.nodes = _usual(lay_out(conditions.robots))
        self._conditions = conditions
        self._spec = folder / "specs.toml"
        self._stack = ExitStack()
        self._folder = folder
        self._lock = Lock()
        self._frames, self._age = 0, 0.0
        self._start = 0.0
        self._apps = Apps()
        self._set_air: Callable[[Air], None] = lambda _: None

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            self._open(stack)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def run(self, seconds: float, tell: Callable[[Seen], None]) -> None:
        """Go on for so long [s], and tell each second what the operator saw. Raises DemoError."""
        coming = self._episodes()
        following = next(coming)
        for second in count(1):
            due = min(self._start + second, self._start + seconds)
            while not self._conditions.footage and self._start + following.start - 2.0 * AHEAD < due:
                self._put(following)
                following = next(coming)
            time.sleep(max(0.0, due - time.monotonic()))
            self._troupe.check()
            with self._lock:
                seen = Seen(time.monotonic() - self._start, self._frames, self._age)
                self._frames, self._age = 0, 0.0
            tell(seen)
            if due >= self._start + seconds:
                return

    def channel(self, wanted: object) -> Air:
        """Change the medium, and the robots' limit with it; return it. Raises AirError."""
        with self._lock:
            air = self.air.changed(wanted)
            self._set_air(air)
            if air.limit != self.air.limit:
                self._follow(air)
            self.air = air
        return air

    def red(self, wanted: object) -> None:
        """Put a red object into a robot's way. Raises AirError."""
        robots = self.robots
        robot = wanted.get("robot") if isinstance(wanted, dict) else None
        if not isinstance(wanted, dict) or set(wanted) != {"robot"}:
            raise AirError('something red is put into a way with {"robot": name}')
        if not robots:
            raise AirError("robot: all replay footage, into which nothing can be put")
        if robot not in robots:
            raise AirError(f"robot: {robot!r:.60} is none of {', '.join(robots)}")
        start = time.monotonic() - self._start + AHEAD
        self._put(Episode(robots.index(str(robot)), start, start + LASTS))

    @property
    def robots(self) -> list[str]:
        """Into whose way something can be put."""
        return [] if self._conditions.footage else [node.name for node in self.nodes[1:]]

    def _open(self, stack: ExitStack) -> None:
        conditions, folder = self._conditions, self._folder
        dials: dict[str, list[str]]
        if conditions.netns:
            namespaces = stack.enter_context(Namespaces(conditions.air))
            self.nodes = namespaces.add(self.nodes)
            dials, self._set_air = namespaces.dials(self.nodes), namespaces.change
        self._troupe = stack.enter_context(Troupe(folder))
        if not conditions.netns:
            medium, dials = start_medium(self._troupe, self.nodes, conditions.air, None)
            self._set_air = _telling(medium)
        spec = SURVEILLANCE.format(limit=SHARE * conditions.rate, window=WINDOW)
        start_daemons(self._troupe, self.nodes, dials, spec, folder)
        cast = Cast(conditions.robots, FOREVER, conditions.seed, conditions.footage)
        self._apps = start_robots(self._troupe, self.nodes, cast, None, told=True)
        session = stack.enter_context(open_client(self.nodes[0].app_endpoint))
        self._serve(stack, session)
        self._start = time.monotonic() + LEAD
        for app in self._apps.all:
            app.tell(self._start)

    def _serve(self, stack: ExitStack, session: zenoh.Session) -> None:
        """Watch as an operator does, and answer."""
        for key in ("robot/*/position", "robot/*/battery"):
            stack.enter_context(session.declare_subscriber(key, lambda _: None))
        stack.enter_context(session.declare_subscriber("robot/*/camera", self._receive))
        stack.enter_context(session.declare_queryable(CHANNEL, self._answer_channel))
        stack.enter_context(session.declare_queryable(RED, self._answer_red))

    def _receive(self, sample: zenoh.Sample) -> None:
        _, t_gen = read_stamp(bytes(sample.attachment or b""))
        with self._lock:
            self._frames += 1
            self._age = max(self._age, time.monotonic() - t_gen)

    def _answer_channel(self, query: zenoh.Query) -> None:
        with query:
            try:
                air = self.air if query.payload is None else self.channel(read_json(bytes(query.payload)))
            except (AirError, DemoError) as error:
                query.reply_err(str(error))
            else:
                query.reply(CHANNEL, air.to_json(), encoding=zenoh.Encoding.APPLICATION_JSON)

    def _answer_red(self, query: zenoh.Query) -> None:
        with query:
            try:
                if query.payload is not None:
                    self.red(read_json(bytes(query.payload)))
            except AirError as error:
                query.reply_err(str(error))
            else:
                answer = json.dumps({"robots": self.robots})
                query.reply(RED, answer, encoding=zenoh.Encoding.APPLICATION_JSON)

    def _put(self, episode: Episode) -> None:
        for camera in self._apps.cameras:
            camera.tell(asdict(episode))

    def _follow(self, air: Air) -> None:
        """Write the limit into the spec that all daemons have, whatever else somebody made of it."""
        text = with_limit(self._spec.read_text(), SHARE * 8 * air.limit)
        fresh = self._spec.with_suffix(".new")
        fresh.write_text(text)
        fresh.replace(self._spec)

    def _episodes(self) -> Iterator[Episode]:
        """Yield whose turn it is to meet something red, for ever."""
        for turn in count():
            for each in schedule(self._conditions.seed + turn, self._conditions.robots, TURN - 6.0):
                yield replace(each, start=each.start + TURN * turn, end=each.end + TURN * turn)


FOREVER = 1e9
"""Longer than anybody looks [s]."""


def _telling(medium: Process) -> Callable[[Air], None]:
    return lambda air: medium.tell(asdict(air))


def _usual(nodes: tuple[Node, ...]) -> tuple[Node, ...]:
    """Have the operator's daemon listen where daemons usually do, if nobody does: commands find it there."""
    if not is_free(USUAL_PORT):
        return nodes
    return replace(nodes[0], app_port=USUAL_PORT), *nodes[1:]
