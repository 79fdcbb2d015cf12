"""The decisions from the root to where a search stands: states of the streams and use of the constraints."""

from planner.tables import Tables


class Path:
    """A sequence of decisions, level by level; a step and a check take constant time."""

    def __init__(self, tables: Tables) -> None:
        gains, checks = tables.gains, tables.checks
        self.stream: list[int] = gains.stream.tolist()
        self.number: list[int] = gains.number.tolist()
        self.start: list[int] = gains.start.tolist()
        self._gain: list[float] = tables.aim.tolist()
        self._use: list[list[float]] = checks.use.tolist()
        self._check_start: list[int] = checks.start.tolist()
        self._checks = list(zip(checks.of.tolist(), checks.first.tolist(), checks.room.tolist(), strict=True))
        self._held: list[int] = checks.held.tolist()
        self._streams = tables.streams
        constraints = checks.use.shape[1]
        self.used = [[0.0] * constraints for _ in range(tables.levels + 1)]
        """used[d]: what the levels before d use, per constraint."""
        self.state = [0] * self._streams
        """The state of each stream: 0, or 1 + the number of its last open message sent."""
        self.sends: list[int] = []
        """The levels that send."""

    def reset(self) -> None:
        """Go back to the root."""
        self.state = [0] * self._streams
        self.sends = []

    def gain(self, level: int) -> float:
        """Return what sending the message of this level adds to what the search maximises [utility·s]."""
        return self._gain[self.start[level] + self.state[self.stream[level]]]

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
            self.state[self.stream[level]] = self.number[level] + 1
            self.sends.append(level)

    def count(self, level: int, *, send: bool) -> None:
        """Count what the message of this level uses, and no more."""
        if send:
            use = self._use[level]
            self.used[level + 1] = [before + more for before, more in zip(self.used[level], use, strict=True)]
        else:
            self.used[level + 1] = self.used[level]

    def after(self, level: int, *, send: bool) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Return the streams' states and the sends that coming checks count, once this level is decided."""
        state, sends = list(self.state), list(self.sends)
        if send:
            state[self.stream[level]] = self.number[level] + 1
            sends.append(level)
        held = tuple(sent for sent in sends if sent >= self._held[level + 1] and any(self._use[sent]))
        return tuple(state), held
