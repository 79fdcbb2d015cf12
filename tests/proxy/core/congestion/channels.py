"""A capacity whose peers speak, and tell what they see."""

import math

from planner import Throughput
from proxy.core.congestion.channel import Capacity
from proxy.core.congestion.control import Traffic
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest, Echo

RATE = 100_000.0
AIR = Limit("air", 0.5, RATE * 0.5, Throughput(RATE), 0.05)
BEGIN = math.sqrt(AIR.least)
"""What is in force of it at first."""
FIXED = Limit("fixed", 0.5, RATE, Throughput(2 * RATE))


class Channel:
    """A capacity whose peers speak every 0.1 s; `waits` by peer are what they see and say, None: nothing comes."""

    def __init__(self, peers=("op",), receivers=("op",)):
        self.capacity = Capacity(0.0, "us")
        self.capacity.set_limits(0.0, (FIXED, AIR))
        self.receivers, self.now, self.sent, self.dropped = receivers, 0.0, 0, 0
        self.waits = dict.fromkeys(peers, 0.0)
        self.tells = dict.fromkeys(peers, 1.0)
        self.arriving = 1.0
        self.use = 1.0
        self.drops = True
        self.hears_us = True
        self.leader = ""
        self.tells_use = ()

    def run(self, seconds):
        """Let the time pass; the channel is used by as much of the limit in force as `use` says."""
        for _ in range(round(seconds * 10)):
            self.now = round(self.now + 0.1, 6)
            self.sent += 1000 * self.use * self.factor * RATE * 0.1 / 1000
            self.dropped += self.drops
            self.capacity.evidence.sent(self.now, round(self.sent / 1000), round(self.sent))
            digest = Digest("us", "us", self.now - 0.05, round(self.sent / 1000), round(self.sent))
            self.capacity.reported(digest)
            for number, (peer, wait) in enumerate(self.waits.items()):
                if wait is not None:
                    self._speak(peer, wait, self.now - 0.001 * number, digest)
            if self.now >= self.capacity.due_at:
                self.capacity.look(self.now, Traffic(self.dropped, self.receivers, 0.0, (0.01,), (0.01,), self.leader))
        return self

    def _speak(self, peer, wait, now, ours):
        samples = round(self.sent / 1000 * self.arriving)
        echoes = (Echo("us", ours.sent, ours.sent + 500.0 + wait, samples, 0.0),) if self.hears_us else ()
        capacity = self.tells[peer], *self.tells_use
        told = Digest(peer, peer, now + 77.0 - wait, 0, 0, echoes=echoes, capacity=capacity)
        self.capacity.digest_received(now, told, now)

    @property
    def factor(self):
        (factor,) = self.capacity.factors
        return factor

    @property
    def why(self):
        return self.capacity.described(self.now, 0)["reason"]


def queue_of(channel, *waits, peers=("op",)):
    """Let a queue grow in front of these peers, to as much as the last of these."""
    for wait in waits:
        channel.waits |= dict.fromkeys(peers, wait)
        channel.run(0.1)
    return channel
