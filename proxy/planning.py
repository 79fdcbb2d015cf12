"""Every decision by its deadline: searches on their threads, and word to the core where there is no answer in time."""

from functools import partial

from planner import SearchSettings
from proxy import clock
from proxy.core.interface.commands import Decide
from proxy.core.interface.events import DecisionLate, DecisionReady, Event
from proxy.loop import Loop
from proxy.worker import Worker


class Planning:
    """Answers each `Decide` of the core on this loop. What others should send keeps no sample of ours waiting."""

    def __init__(self, settings: SearchSettings, deadline: float, loop: Loop) -> None:
        self.settings = settings
        self._deadline = deadline
        self._loop = loop
        self._samples = Worker(settings, deadline, lambda answer: loop.post(partial(self._ready, answer)))
        self._ahead = Worker(settings, deadline, loop.post)
        self._told = -1
        """The ticket of the last decision of which the core knows the answer, or that there is none in time."""

    def start(self) -> None:
        """Start answering."""
        self._samples.start()
        self._ahead.start()

    def close(self, timeout: float) -> None:
        """Stop after the decisions in hand; wait for them at most `timeout` [s]."""
        end = clock.monotonic() + timeout
        self._samples.close(timeout)
        self._ahead.close(max(0.0, end - clock.monotonic()))

    def decide(self, command: Decide) -> None:
        """Have it decided; a sample waits until its deadline, and not at all behind a search that is overdue.

        On the loop's thread only.
        """
        if command.ahead:
            self._ahead.submit(command)
            return
        overdue = self._samples.busy(clock.monotonic())
        self._samples.submit(command)
        self._loop.at(command.asked + (0.0 if overdue else self._deadline), partial(self._due, command.ticket))

    def _ready(self, answer: DecisionReady) -> Event | None:
        """Pass an answer on; after the deadline nobody waits for it. On the loop's thread."""
        return self._tell(answer) if answer.ticket > self._told else None

    def _due(self, ticket: int) -> Event | None:
        """It is time for the answer: let the core know of it, or that there is none, unless it does already."""
        return self._tell(self._samples.due(ticket)) if ticket > self._told else None

    def _tell(self, event: DecisionReady | DecisionLate) -> Event:
        self._told = event.ticket
        return event

    def stuck(self, now: float) -> bool:
        """Whether a search does not come to its end."""
        return self._samples.stuck(now) or self._ahead.stuck(now)
