"""A core of a robot that keeps copies for others that vanish and come back."""

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward, SendCopy
from proxy.core.protocol.messages import State, tag
from tests.proxy.core.talk import Talk, only

ALARMS = """
[[information_type]]
name = "alarm"
keys = ["alarm/*"]
aggregation = "{aggregation}"
utility = {{ kind = "step", lifetime = "60 s" }}
[[information_type]]
name = "camera"
keys = ["camera/*"]
utility = {{ kind = "video" }}
"""

LIMIT = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 1.0
"""

ZID, OTHER = "zz-away00", "yy-here00"

KEYS = ("alarm/*", "camera/*")


class Away(Talk):
    """Talks to a core of a robot that vanishes and comes back."""

    def arrive(self, now, robot="away", zid=ZID, keys=KEYS):
        said = self.tell(ev.PeerAppeared(now, robot, zid))
        return said + self.tell(ev.StateHeard(now, State(robot, zid, "enforce", self.specs.generation, (), keys)))

    def vanish(self, now, robot="away", zid=ZID):
        return self.tell(ev.PeerGone(now, robot, zid))

    def alarm(self, now, key="alarm/a", **rest):
        """Publish, hand over what is forwarded at once, and return the number."""
        sample, commands = self.publish(now, key, **rest)
        for command in only(commands, Forward):
            self.tell(ev.SampleHanded(now, command.sample))
        return sample

    def settle(self, now, *, send=False):
        """Answer all that is to be decided; return what is commanded then."""
        said = []
        while self.core.gate.search.pending is not None:
            (decide,) = [each for each in self.all(Decide) if each.ticket == self.core.gate.search.pending.ticket]
            said += self.answer(now, decide, send=send)
        return said

    @property
    def kept(self):
        return self.core.status(0.0)["kept"]

    def copies(self, commands=None):
        return [(copy.sample, tag(copy.to)) for copy in only(self.said if commands is None else commands, SendCopy)]


def to_away(*samples):
    return [(sample, tag(ZID)) for sample in samples]


def catch_up(talk, times, events=(), apart=1.0):
    """Alarms of 1 kB, `apart` [s], while a robot is away, and at `times`, when it gets its copies; all, and the latter.

    Before the first of those there are `events`.
    """
    samples, live = [], []
    for number in range(15):
        samples.append(talk.alarm(2.0 + apart * number, size=1000))
        talk.settle(2.0 + apart * number, send=True)
    now, due = max(30.0, 3.0 + apart * number), list(times)
    said = talk.arrive(now)
    while talk.kept["waiting"] or talk.core.gate.undecided.inbox or due:
        while due and due[0] <= now:
            for event in () if live else events:
                talk.tell(event)
            live.append(talk.alarm(due.pop(0), size=1000))
        for sample, to in talk.copies(said):
            talk.tell(ev.CopyHanded(now, sample, to))
        now += 0.05
        assert now < 99.0
        said = talk.tell(ev.TimePassed(now)) + talk.settle(now, send=True)
    return [*samples, *live], live
