"""A core and a mesh that cannot be trusted: honest robots, and whatever else may be said on Sendworthy's keys."""

from planner import Plan
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward, Reread
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.samples.inbox import SUPERSEDED
from proxy.core.view.tuning import TUNING

STREAMS = 300
"""Streams that the core may keep; few, so that the bound is met, but one for each robot that there may be."""
HONEST = "aaaaaaaa01"
KEY = "robot/honest/camera"


class Besieged:
    """A core with one honest robot on the mesh. `act` is an event, hostile or not; `check` what must hold after it."""

    def __init__(self, specs, coordination="split"):
        settings = CoreSettings("r1", "0000000001", streams=STREAMS, coordination=coordination, settle=0.0, away=20.0)
        self.core = Core(settings, specs, 0.0)
        self.now, self.samples, self.generated = 0.0, 0, 0
        self.open, self.undecided, self.unread = set(), {}, []
        self.act(ev.PeerAppeared(0.0, "honest", HONEST))
        streams = (StreamState(1, KEY, "camera", 0.5),)
        state = State("honest", HONEST, "enforce", "", streams, ("robot/*/camera",), number=1)
        self.act(ev.StateHeard(0.0, state))
        self.speak()

    def pass_time(self, seconds):
        self.now += seconds
        self.act(ev.TimePassed(self.now))

    def speak(self):
        """The honest robot publishes a frame and tells of it."""
        self.now += 0.5
        self.generated += 1
        news = StreamDigest(1, self.generated, self.generated, self.now, self.now, 1000, 1.0)
        digest = Digest("honest", HONEST[:8], self.now, self.generated, 1000 * self.generated, (news,), state=1)
        self.act(ev.DigestHeard(self.now, digest))

    def publish(self, key="robot/r1/camera", size=500, **rest):
        """One of our own apps publishes."""
        self.samples += 1
        self.open.add(self.samples)
        self.act(ev.SamplePublished(self.now, self.samples, key, size, self.now, None, 5, {"red": 0.1}, **rest))

    def act(self, event):
        """Feed one event, and answer what the core asks of its driver."""
        for command in self.core.handle(event):
            match command:
                case Decide():
                    self.undecided[command.ticket] = command
                case Forward(sample):
                    self.open.remove(sample)
                    self.act(ev.SampleHanded(self.now, sample))
                case Drop(sample):
                    self.open.remove(sample)
                case Reread(sample):
                    self.unread.append(sample)

    def read(self):
        """The driver reads again what it was asked to."""
        while self.unread:
            self.act(ev.SampleReread(self.now, self.unread.pop(), {"red": 0.2}))

    def decide(self, *, send):
        """The worker answers all that it was asked."""
        while self.undecided:
            ticket, command = self.undecided.popitem()
            sends = (command.problem.current,) if send else ()
            self.act(ev.DecisionReady(self.now, ticket, Plan(send, sends, 1.0, None, 1, 1)))

    def check(self):
        """Conservation, bounds, and an honest robot that is known as what it is."""
        core, view = self.core, self.core.view
        assert core.counts.conserved
        assert core.kept.copies.conserved
        assert core.counts.by_reason.total() - core.counts.by_reason[SUPERSEDED] <= self.samples
        assert len(list(view.streams)) <= STREAMS
        assert sum(map(len, view.streams._owned.values())) == len(view.streams._all)
        assert len(view.peers) <= TUNING.peers
        assert len({peer.robot for peer in view.peers.values()} | {"r1"}) == len(view.peers) + 1
        assert len(view.origins.own) <= 256
        assert len(view.streams._matching) <= TUNING.matching_keys
        assert all(len(peer.pending) <= TUNING.pending_news for peer in view.peers.values())
        assert len(core.parts.unknown_senders._heard) <= TUNING.unknown_senders
        assert all(len(kept) <= TUNING.unknown_digests for kept in core.parts.unknown_senders._heard.values())
        assert set(core.gossip.requests._open) <= set(view.peers)
        taking_part = view.peers.keys() - core.mismatched.found
        assert core.coordination.team._votes <= taking_part
        assert core.wake_at(self.now) >= self.now
        honest = view.peers[HONEST[:8]]
        assert (honest.name, honest.keys, honest.state.subscriptions) == ("honest", {1: KEY}, ("robot/*/camera",))
        stream = view.streams.known(honest.robot, KEY)
        assert stream is not None
        assert stream.generated == self.generated
        assert view.origins.robot_of(HONEST) == honest.robot

    def finish(self):
        """In the end everything that was published is accounted for, and the status can be told."""
        self.pass_time(1.0)
        self.decide(send=True)
        self.check()
        assert self.core.counts.queued == len(self.open)
        assert self.core.status(self.now)["counts"]["conserved"]
