"""Every decision by its deadline, and word to the core where there is no answer in time.

Nearly all searches take less time than it takes to wake another thread. So each begins on the thread that uses the
core, and only what lasts goes on elsewhere, as does what an operator's own models take part in, which may last forever.
"""

from functools import partial

from planner import Aggregation, Custom, Problem, SearchSettings
from proxy import clock
from proxy.core.interface.commands import Decide
from proxy.core.interface.events import DecisionLate, DecisionReady, Event
from proxy.loop import Loop
from proxy.tuning import TUNING
from proxy.worker import Decision, Worker

RECENT = 20
"""Over how many decisions it is told how many are in time."""


class Planning:
    """Answers each `Decide` of the core on this loop. What others should send keeps no sample of ours waiting."""

    def __init__(self, settings: SearchSettings, deadline: float, loop: Loop) -> None:
        self.settings = settings
        self._deadline = deadline
        self._loop = loop
        self._samples = Worker(deadline, self._post)
        self._told = -1
        """The ticket of the last decision of which the core knows the answer, or that there is none in time."""
        self._late = self._cut = 0.0
        """What part of the recent decisions was not there in time, and was cut short."""

    def close(self, timeout: float) -> None:
        """Stop after the decisions in hand; wait for them at most `timeout` [s]."""
        self._samples.close(timeout)

    def decide(self, command: Decide) -> None:
        """Have it decided; a sample waits until its deadline, and not at all behind a search that is overdue.

        By the thread that uses the core only.
        """
        decision = Decision(command, self.settings, self._deadline)
        now = clock.monotonic()
        if not _may_last(command.problem) and (answer := decision.work(now + TUNING.decided_at_once)) is not None:
            self._post(answer)
            return
        overdue = self._samples.busy(now)
        self._samples.submit(decision)
        self._loop.at(command.asked + (0.0 if overdue else self._deadline), partial(self._due, decision))

    def _post(self, answer: DecisionReady) -> None:
        self._loop.post(partial(self._ready, answer))

    def _ready(self, answer: DecisionReady) -> Event | None:
        """Pass an answer on; after the deadline nobody waits for it. By the thread that uses the core."""
        return self._tell(answer) if answer.ticket > self._told else None

    def _due(self, decision: Decision) -> Event | None:
        """It is time for the answer: let the core know of it, or that there is none, unless it does already."""
        ticket = decision.command.ticket
        return self._tell(decision.answer or DecisionLate(clock.monotonic(), ticket)) if ticket > self._told else None

    def _tell(self, event: DecisionReady | DecisionLate) -> Event:
        self._told = event.ticket
        late = isinstance(event, DecisionLate)
        self._late += (late - self._late) / RECENT
        cut = isinstance(event, DecisionReady) and event.cut
        self._cut += (cut - self._cut) / RECENT
        return event

    def stuck(self, now: float) -> bool:
        """Whether a search does not come to its end."""
        return self._samples.stuck(now)

    def warnings(self, now: float) -> list[str]:
        """Say when searches take too long."""
        if self.stuck(now):
            return [
                "the planner hangs in a search, so samples are sent if they fit: see models of your own in the specs"
            ]
        slow, more = f"planner.deadline, {self._deadline * 1e3:g} ms", "sendworthy profile says what takes the time"
        if self._late > 0.5:
            return [f"most decisions take longer than {slow}, so samples are sent if they fit; {more}"]
        if self._cut > 0.5:
            return [f"most searches are cut short by {slow}, and decide worse than they could; {more}"]
        return []


def _may_last(problem: Problem) -> bool:
    """Whether an operator's own models take part."""
    kinds = {type(stream.aggregation) for stream in problem.streams}
    return not kinds <= {Aggregation} or Custom in {type(message.utility) for message in problem.messages}
