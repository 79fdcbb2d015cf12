"""A robot of a team whose news take as long as a test says."""

import pytest

from planner.measures import Energy, Messages, Throughput
from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.model.limits import Limit, limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest
from proxy.core.view.stream import Generated
from proxy.core.view.view import SharedView

BYTES = Limit("bytes", 1.0, 1000.0, Throughput(1000.0, 1.0))
COUNT = Limit("count", 0.5, 4.0, Messages(4, 0.5))
ENERGY = Limit("energy", 2.0, 3.0, Energy(3.0, 2.0, per_byte=1e-3))
WINDOW = 2.0


class Robot:
    """A robot and others, whose news take as long as it is told; the first so many of all have something to `send`."""

    def __init__(self, specs, peers=("p1", "p2"), *, send=2, size=1000, **settings):
        self.view = SharedView(CoreSettings("r1", "z1", **settings), specs)
        self.coordination = Coordination(0.0, self.view.settings, self.view)
        self.limits = limits_of(specs, 0.02, len(peers) + 1)
        self.now = 0.0
        for peer in peers:
            self.view.add_peer(0.0, peer, peer)
        self.coordination.set_limits(0.0, self.limits)
        self.coordination.set_members(0.0, peers)
        self.view.subscribers.set_own(("robot/**",))
        for robot in ("r1", *peers)[:send]:
            stream = self.view.streams.touch(0.0, robot, f"robot/{robot}/camera")
            stream.matching = True
            for count in range(9):
                stream.note_generated(count + 1, Generated(count - 8.5, size, 1.0))

    def look(self, *, waiting=0.0, announcing=0.0, using=0.0, words=0.0):
        """Look again; what is told of parts can go after so long, `words`."""
        self.now += TUNING.interval
        return self.coordination.advance(
            self.now, self.limits, waiting, lambda _: announcing, lambda _: using, passes_at=lambda now: now + words
        )

    def go_on(self):
        """Streams that began go on, one sample a second."""
        for stream in self.view.streams:
            while stream.schedule.period and (due := stream.newest.t_gen + 1.0) <= self.now:
                stream.note_generated(stream.generated + 1, stream.newest._replace(t_gen=due))

    def say(self, peer, **digest):
        self.now += 0.01
        self.coordination.heard(self.now, Digest(peer, peer, self.now, **digest))


@pytest.fixture
def make_team(make_specs):
    return lambda *args, **rest: Robot(make_specs(window=WINDOW), *args, **rest)


def names(count):
    return tuple(f"p{number:02d}" for number in range(count))


@pytest.fixture
def make_budget(make_specs):
    """A budget of one robot beside `peers` others."""

    def make(*limits, kind="announce", peers=1, specs=None):
        view = SharedView(CoreSettings("r1", "z1", coordination=kind, settle=0.0), specs or make_specs())
        for number in range(peers):
            view.add_peer(0.0, f"p{number}", f"p{number}")
        coordination = Coordination(0.0, view.settings, view)
        budget = Budget(view, coordination)
        coordination.set_members(0.0, view.peers)
        coordination.set_limits(0.0, limits or (BYTES,))
        budget.set_limits(limits or (BYTES,))
        return budget, view

    return make


def heard(view, now, size):
    """A sample of another robot that no spec covers comes."""
    view.overhearing.take(ev.SampleHeard(now, "other", size, "p0", None, None))
