"""The decisions from the root to where a search stands: states of the streams and use of the constraints."""

from collections.abc import Hashable
from dataclasses import dataclass

from planner.aggregations.custom import CustomStream, States
from planner.tables import Tables


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A path to come back to."""

    used: list[list[float]]
    state: list[int]
    sends: list[int]
    received: dict[int, tuple[States, int]]


class Path:
    """A sequence of decisions, level by level; a step and a check take constant time."""

    def __init__(self, tables: Tables) -> None:
        gains, checks = tables.gains, tables.checks
        self.stream: list[int] = gains.stream.tolist()
        self.start: list[int] = gains.start.tolist()
        self.leads_to: list[int] = gains.after.tolist()
        """By entry of the gains: the state that sending leads to."""
        self._gain: list[float] = gains.aim.tolist()
        self._markovian: list[bool] = gains.markovian.tolist()
        self._models = gains.open_ended
        self._charge = (
            [0.0] * tables.levels if tables.beyond is None else tables.beyond.charge[list(tables.message)].tolist()
        )
        self._use: list[list[float]] = checks.use.tolist()
        self._check_start: list[int] = checks.start.tolist()
        self._checks = list(zip(checks.of.tolist(), checks.first.tolist(), checks.room.tolist(), strict=True))
        self._held: list[int] = checks.held.tolist()
        self._streams = tables.streams
        constraints = checks.use.shape[1]
        self.used = [[0.0] * constraints for _ in range(tables.levels + 1)]
        """used[d]: what the levels before d use, per constraint."""
        self.state = [0] * self._streams
        """The state of each stream, as in the table of gains."""
        self.sends: list[int] = []
        """The levels that send."""
        self._received: dict[int, tuple[States, int]] = {}
        """Of open-ended streams: what was received, and the place up to which."""

    def reset(self) -> None:
        """Go back to the root."""
        self.state = [0] * self._streams
        self.sends = []
        self._received = {}

    def save(self) -> Snapshot:
        """Return the path as it is."""
        return Snapshot(list(self.used), list(self.state), list(self.sends), dict(self._received))

    def load(self, snapshot: Snapshot) -> None:
        """Go back to a path that was saved."""
        self.used, self.state = list(snapshot.used), list(snapshot.state)
        self.sends, self._received = list(snapshot.sends), dict(snapshot.received)

    def entry(self, level: int) -> int:
        """Return where the gain of this level stands in the table, in the present state of its stream."""
        return self.start[level] + self.state[self.stream[level]]

    def gain(self, level: int) -> float:
        """Return what sending the message of this level adds to what the search maximises [utility·s]."""
        model = self._models[self.stream[level]]
        if model is None:
            return self._gain[self.entry(level)]
        before, sent, place = self._arrived(model, level)
        return model.worth(sent, place + 1)[1] - model.worth(before, place + 1)[1] - self._charge[level]

    def _arrived(self, model: CustomStream, level: int) -> tuple[States, States, int]:
        """Return what is received before the message of a level, with it, and its place."""
        states, begin = self._received.get(self.stream[level], (None, 0))
        place = model.place(level)
        before = model.arrive(model.empty() if states is None else states, begin, place)
        return before, model.add(before, place), place

    def fits(self, level: int) -> bool:
        """Whether every constraint (Eq. 5) allows to send the message of this level."""
        used = self.used
        for at in range(self._check_start[level], self._check_start[level + 1]):
            of, first, room = self._checks[at]
            if used[level][of] - used[first][of] > room:
                return False
        return True

    def step(self, level: int, *, send: bool) -> None:
        """Decide the message of this level."""
        self.count(level, send=send)
        if send:
            stream = self.stream[level]
            model = self._models[stream]
            if model is not None:
                _, sent, place = self._arrived(model, level)
                self._received[stream] = sent, place + 1
            self.state[stream] = self.leads_to[self.entry(level)]
            self.sends.append(level)

    def count(self, level: int, *, send: bool) -> None:
        """Count what the message of this level uses, and no more."""
        if send:
            use = self._use[level]
            self.used[level + 1] = [before + more for before, more in zip(self.used[level], use, strict=True)]
        else:
            self.used[level + 1] = self.used[level]

    def held(self, level: int, *, send: bool) -> tuple[int, ...]:
        """Return the sends that coming checks count once this level is decided."""
        sends = [*self.sends, level] if send else self.sends
        return tuple(sent for sent in sends if sent >= self._held[level + 1] and any(self._use[sent]))

    def states(self, level: int, *, send: bool) -> tuple[Hashable, ...]:
        """Return the states of the streams once this level is decided; sets of sends for open-ended ones."""
        state: list[Hashable] = list(self.state)
        if send:
            state[self.stream[level]] = self.leads_to[self.entry(level)]
        for stream, model in enumerate(self._models):
            if model is not None:
                state[stream] = self._sent_of(stream, level, send=send)
        return tuple(state)

    def kept(self, level: int, *, send: bool) -> tuple[Hashable, ...]:
        """Return what Eq. 7 compares once this level is decided: Markovian streams' last message, others' sets."""
        sent = [self._sent_of(stream, level, send=send) for stream in range(self._streams)]
        return tuple(
            levels[-1:] if markovian else levels for levels, markovian in zip(sent, self._markovian, strict=True)
        )

    def _sent_of(self, stream: int, level: int, *, send: bool) -> tuple[int, ...]:
        """Return the levels of a stream that are sent once this level is decided."""
        sends = [*self.sends, level] if send else self.sends
        return tuple(sent for sent in sends if self.stream[sent] == stream)
