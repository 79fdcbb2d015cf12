"""Cores in flight, whose snapshots are taken between two events."""

import json

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide
from proxy.recording.json_data import text
from proxy.recording.snapshots import restored, taken
from proxy.recording.writing import described
from studies.simulation.missions import specs_of
from studies.simulation.traffic.comparison import Cell, how_of
from studies.simulation.traffic.flights import crew


def answer(core, event):
    """Hand an event to a core; return what it asks for, as plain data."""
    return [json.loads(text(described(command))) for command in core.handle(event)]


class Doubled:
    """A core, and beside it another one that is made of a snapshot of it now and then, which must do the same.

    A quarter of the snapshots at least is taken while a search is under way, if there is any."""

    def __init__(self, core, every, change=None, load=None):
        self.core = core
        self._load = load
        self.snapshots = self.searching = self.events = 0
        self._every = every
        self._change = change or {}
        self._double = None

    def __getattr__(self, name):
        return getattr(self.core, name)

    def handle(self, event):
        """Take in an event, twice."""
        if self.events in self._change:
            self._take(self._change[self.events](event.now))
        return self._take(event)

    def _take(self, event):
        searches = self.core.asked is not None and 4 * self.searching < self.snapshots
        if self.events % self._every == 0 or searches:
            self._renew(event.now)
        self.events += 1
        commands = self.core.handle(event)
        if self._double is not None:
            assert answer(self._double, event) == [json.loads(text(described(each))) for each in commands], event
            assert self._double.wake_at(event.now) == self.core.wake_at(event.now)
        return commands

    def _renew(self, now):
        snapshot = taken(self.core, self.events, now)
        self._double = restored(snapshot, self._load() if self._load else self.core.view.specs)
        self.snapshots += 1
        asked, ours = self._double.asked, self.core.asked
        assert (asked is None) == (ours is None)
        if isinstance(ours, Decide):
            self.searching += 1
            assert (asked.ticket, asked.seed, asked.iterations) == (ours.ticket, ours.seed, ours.iterations)
            assert len(asked.problem.messages) == len(ours.problem.messages)


def flown(workload, robots, team, *, loss=0.01, change=None, seconds=7.0, every=53):
    """Fly a mission with doubled cores; return these."""
    cell = Cell(workload, robots, 0.02, loss, 0, seconds)
    how = how_of(cell, team)
    mission = cell.mission(everybody=how.broadcasts)
    crewed = crew(mission, how, 0)
    changes = change(mission) if change else {}
    for member in crewed.members.values():
        member.core = Doubled(member.core, every, changes)
    crewed.run(mission.frames, seconds)
    return [member.core for member in crewed.members.values()]


def fewer_types(mission):
    """Return when the specs change to ones of fewer types, and back."""
    whole = mission.specs
    first, *types = whole.texts[0][1].split("[[information_type]]")
    less = specs_of("[[information_type]]".join([first, *types[:2]]))
    return {300: lambda now: ev.SpecsChanged(now, less), 500: lambda now: ev.SpecsChanged(now, whole)}
