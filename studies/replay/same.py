"""The exact replay: the core of a recording, driven through the same events, decides the same to the last.

It begins as the core did, or with a snapshot of it. The searches are done anew, for as many iterations as were done
then; each plan and each command is compared with what stands in the recording. Beyond what is missing there, or the
first difference, the core is another one: nothing can be told until the next snapshot.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from planner import Plan, SearchSettings, start
from proxy.core.core import Core
from proxy.core.interface.commands import Decide
from proxy.core.interface.events import DecisionReady, Event, SpecsChanged
from proxy.recording.entries import Entry, Gap, Happened, Snapshot, SpecsText, Start
from proxy.recording.errors import RecordingError
from proxy.recording.json_data import plain, text
from proxy.recording.reading import RecordingReader
from proxy.recording.snapshots import check, restored
from proxy.recording.writing import described
from studies.replay.specs import specs_of


@dataclass(slots=True)
class Sameness:
    """What an exact replay found: from where on, how far it came, and why it ended there if not at the end."""

    first: int = 0
    """The number of the event that it began with."""
    began: float = 0.0
    """When that was [s]."""
    events: int = 0
    decisions: int = 0
    """Searches that were done anew."""
    commands: int = 0
    seconds: float = 0.0
    """Of the robot's life that were replayed."""
    difference: str = ""
    """Where it first differs, and how; empty: nowhere."""
    ended: str = ""
    """Why it ended before the recording does."""

    @property
    def equal(self) -> bool:
        """Whether all was as recorded, as far as it went."""
        return not self.difference


class SameReplay:
    """Drives the core that a recording begins with, or the first that there is a snapshot of.

    Raises RecordingError where that cannot be built. `specs` are those that the recording had before, by generation;
    the `python` that they name runs only where that is wanted.
    """

    def __init__(self, begin: Start, specs: Mapping[str, SpecsText] | None = None, *, python: bool = False) -> None:
        if begin.kind != "robot" or begin.settings is None:
            raise RecordingError("it holds mere traffic: nothing was decided that could be compared")
        self._begin = begin
        self._search = begin.search or SearchSettings()
        self._core: Core | None = None
        self._python = python
        self._specs = dict(specs or {})
        self._asked: dict[int, Decide] = {}
        self.found = Sameness(begin.number, begin.now)

    @property
    def begins(self) -> bool:
        """Whether there is anything to begin with, so far."""
        return self._begin.whole or self._core is not None

    def next(self) -> "SameReplay":
        """Return the replay that goes on with the next snapshot."""
        return SameReplay(replace(self._begin, whole=False), self._specs, python=self._python)

    def take(self, entry: Entry) -> bool:
        """Take in what comes next; whether it can go on."""
        match entry:
            case Start():
                self._go_on(entry)
            case SpecsText():
                self._specs[entry.generation] = entry
            case Snapshot() if not self.begins:
                self._restore(entry)
            case Gap() if entry.events and self.begins:
                self.found.ended = f"{entry.events} events are missing from number {entry.first} on: {entry.reason}"
            case Happened():
                self._happen(entry)
            case _:
                pass
        return not (self.found.difference or self.found.ended)

    def _go_on(self, other: Start) -> None:
        """Another file begins, that of the same life which comes next if all is well."""
        due = self.found.first + self.found.events
        if self.begins and other.number != due:
            self.found.ended = f"the next file begins with event {other.number:,}, not with {due:,}"

    def _restore(self, snapshot: Snapshot) -> None:
        """Begin with what the core knew."""
        check(snapshot)
        self._core = core = restored(snapshot, self._loaded(snapshot.generation))
        self.found.first, self.found.began = snapshot.number, snapshot.now
        if (asked := core.asked) is not None:
            self._asked[asked.ticket] = asked

    def _happen(self, recorded: Happened) -> None:
        if not self.begins:
            return
        core = self._core = self._core or self._made()
        due = self.found.first + self.found.events
        if recorded.number != due & 0xFFFFFFFF:
            self.found.ended = f"events are missing from number {due} on"
            return
        event = self._event(recorded.event)
        commands, fault = list[Mapping[str, Any]](), ""
        try:
            for command in core.handle(event):
                if isinstance(command, Decide):
                    self._asked[command.ticket] = command
                commands.append(json.loads(text(described(command))))
        except Exception as error:  # noqa: BLE001 - the daemon's core failed so, too, or that is the difference
            fault = f"{type(error).__name__}: {error}"
        if isinstance(event, DecisionReady):
            self.found.decisions += event.plan is not None
            self._compare(recorded, "another plan", _plan(recorded.event), _plan(event))
        self._compare(recorded, "other commands", list(recorded.commands), commands)
        self._compare(recorded, "another fault", recorded.fault, fault)
        self.found.events += 1
        self.found.commands += len(commands)
        self.found.seconds = max(self.found.seconds, event.now - self.found.began)

    def _made(self) -> Core:
        begin = self._begin
        if begin.settings is None:
            raise RecordingError("it has no settings of a core")
        return Core(begin.settings, self._loaded(begin.generation), begin.now)

    def _loaded(self, generation: str) -> Any:
        if generation not in self._specs:
            raise RecordingError(f"the specs {generation} are not in the recording")
        return specs_of(self._specs[generation], python=self._python)

    def _event(self, event: Event) -> Event:
        """Return an event as it was handed to the core, with the plan that is found now."""
        if isinstance(event, SpecsChanged):
            return SpecsChanged(event.now, self._loaded(event.specs.generation))
        if not isinstance(event, DecisionReady) or event.plan is None:
            return event
        asked = self._asked.pop(event.ticket, None)
        self._asked = {ticket: each for ticket, each in self._asked.items() if ticket > event.ticket}
        if asked is None:
            return event
        return replace(event, plan=self._planned(asked, event.plan))

    def _planned(self, asked: Decide, then: Plan) -> Plan:
        """Search again for as many iterations as were done then."""
        search = start(asked.problem, self._search, asked.seed)
        search.run(then.iterations)
        return replace(search.plan(), seconds=then.seconds)

    def _compare(self, recorded: Happened, what: str, then: Any, now: Any) -> None:
        if then == now or self.found.difference:
            return
        where = f"event {recorded.number:,} ({type(recorded.event).__name__} at {recorded.event.now:.6f} s)"
        self.found.difference = f"{where} has {what}: {_differing(then, now)}"


def stretches(files: Sequence[RecordingReader], *, python: bool = False) -> Iterator[Sameness]:
    """Replay the files of a life in their order; yield what was found up to each place where the replay ended.

    It goes on with the next snapshot. Raises RecordingError where there is nothing to begin with.
    """
    replay, ended = SameReplay(files[0].start, python=python), False
    for entry in chain.from_iterable(files):
        if not replay.take(entry):
            yield replay.found
            replay, ended = replay.next(), True
            replay.take(entry)
    if replay.begins:
        yield replay.found
    elif not ended:
        raise RecordingError(
            "it begins in the middle of a daemon's life, and what its core knew then is not in it; an exact replay"
            " takes a recording with snapshots of it, or all files from the start of a daemon with `record.on`"
        )


def replayed(files: Sequence[RecordingReader]) -> Sameness:
    """Replay the files of a life as far as nothing is missing; return what was found. Raises RecordingError."""
    return next(stretches(files))


def lives(files: Iterable[RecordingReader]) -> list[list[RecordingReader]]:
    """Return the files of each robot's life, in their order."""
    found: dict[tuple[str, str], list[RecordingReader]] = {}
    for file in files:
        found.setdefault((file.start.robot, file.start.zid), []).append(file)
    return [sorted(each, key=lambda file: (file.start.now, file.start.number)) for each in found.values()]


def _plan(event: Event) -> Mapping[str, Any] | None:
    plan = event.plan if isinstance(event, DecisionReady) else None
    return None if plan is None else json.loads(text(plain(plan)))


def _differing(then: Any, now: Any) -> str:
    """Word the first difference between what was and what is."""
    if isinstance(then, Mapping) and isinstance(now, Mapping):
        name = next(name for name in [*then, *now] if then.get(name) != now.get(name))
        return f"{name} was {_brief(then.get(name))}, and is {_brief(now.get(name))} now"
    if isinstance(then, list) and isinstance(now, list):
        for was, is_now in zip(then, now, strict=False):
            if was != is_now:
                return f"{was.get('command')}: {_differing(was, is_now)}"
        return f"{len(then)} were asked for, and {len(now)} are now"
    return f"it was {_brief(then)}, and is {_brief(now)} now"


def _brief(value: Any) -> str:
    return json.dumps(value)[:200]
