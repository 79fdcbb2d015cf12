"""A mesh of cores without a medium: links that come and go, and lose what they carry."""

import random
from functools import partial

from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import AskState, Decide, Drop, Forward, SendDigest, SendState
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.digest_codec import pack_digest, unpack_digest
from proxy.core.protocol.fixed import ticks
from proxy.core.protocol.messages import tag
from proxy.core.protocol.state_codec import pack_state, unpack_state

STEP = 0.1
"""All cores are woken this often, and what is sent arrives one step later [s]."""


class Mesh:
    """Robots by their ids; `names` may hold one name twice. Publishers never wait for a plan: all is dropped."""

    def __init__(self, specs, names, *, loss=0.0, seed=0):
        self.names = names
        self.now = 1.0
        self.loss = loss
        self._random = random.Random(seed)
        self.cores = {
            zid: Core(CoreSettings(name, zid, settle=0.0, allowance=0.2), specs, self.now)
            for zid, name in names.items()
        }
        self.links = set()
        self.published = dict.fromkeys(names, 0)
        self.states, self.sent = {}, {zid: [] for zid in names}
        self._coming = []
        self._samples = 0

    def link(self, groups):
        """Robots of a group see each other, and nobody else."""
        links = {(a, b) for group in groups for a in group for b in group if a != b}
        for a, b in sorted(self.links - links):
            self.feed(a, ev.PeerGone(self.now, self.names[b], b))
        new, self.links = sorted(links - self.links), links
        for a, b in new:
            self.feed(a, ev.PeerAppeared(self.now, self.names[b], b))

    def publish(self, zid, key):
        self._samples += 1
        self.published[zid] += 1
        self.feed(zid, ev.SamplePublished(self.now, self._samples, key, 1000, self.now, None, 5, {"red": 0.1}))

    def run(self, seconds):
        """Let time pass."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            coming, self._coming = self._coming, []
            for deliver in coming:
                deliver()
            for zid in self.cores:
                self.feed(zid, ev.TimePassed(self.now))

    def feed(self, zid, event):
        for command in self.cores[zid].handle(event):
            match command:
                case SendDigest(digest):
                    self.sent[zid].append(ticks(digest.sent))
                    self._send(zid, partial(self._digest, pack_digest(digest)))
                case SendState(state, update):
                    self.states[zid] = pack_state(state)
                    self._send(zid, partial(self._state, pack_state(update or state)))
                case AskState(robot, asked):
                    other = next(z for z in self.names if tag(z) == asked)
                    assert self.names[other] == robot
                    self._send(zid, self._ask, only=other)
                case Decide(ticket):
                    self._coming.append(partial(self.feed, zid, ev.DecisionReady(self.now, ticket, None, "slow")))
                case Forward(sample):
                    self._coming.append(partial(self.feed, zid, ev.SampleHanded(self.now, sample)))
                case Drop():
                    pass

    def _send(self, zid, receive, only=None):
        for a, b in sorted(self.links):
            if a == zid and only in (None, b) and self._random.random() >= self.loss:
                self._coming.append(partial(self._arrive, a, b, receive))

    def _arrive(self, sender, receiver, receive):
        if (sender, receiver) in self.links:
            receive(sender, receiver)

    def _digest(self, data, sender, receiver):
        digest = unpack_digest(data, self.names[sender], tag(sender), tag(receiver), self.sent[receiver][-64:])
        self.feed(receiver, ev.DigestHeard(self.now, digest, len(data)))

    def _state(self, data, sender, receiver):
        self.feed(receiver, ev.StateHeard(self.now, unpack_state(data, self.names[sender]), len(data)))

    def _ask(self, sender, receiver):
        """The receiver answers."""
        if receiver in self.states:
            self._send(receiver, partial(self._state, self.states[receiver]), only=sender)
            self.feed(receiver, ev.StateAsked(self.now))
