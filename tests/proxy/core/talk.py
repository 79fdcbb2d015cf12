"""Talking to a core: tests read as transcripts of events and commands."""

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.protocol.messages import State
from proxy.core.protocol.state_codec import pack_state

SPEC = """
[[constraint]]
kind = "throughput"
limit = "{limit}"
window = {window}

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "most_recent"
weight = 1.0
utility = {{ kind = "video" }}
scale = "1 + 10 * red"
features.red = {{ kind = "color_fraction", color = "red" }}
forecast = {{ features = "last" }}
"""
UNLIMITED = SPEC[SPEC.index("[[information_type]]") :].replace("{{", "{").replace("}}", "}")
ALL_KINDS = (
    """
[[constraint]]
kind = "energy"
limit = "30 mJ"
window = 2
per_byte = "1 uJ"
per_message = "2 mJ"
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 1
[[constraint]]
kind = "messages"
limit = 12
window = 1
[[constraint]]
kind = "airtime"
limit = "5 %"
rate = "6 Mbit/s"
wifi = "infrastructure"
window = 1
"""
    + UNLIMITED
)
"""Every kind of constraint at once, each of which binds somewhere between messages of 200 B and of 6 kB."""


class Talk:
    """Feeds events to a core and keeps what it commands, by kind."""

    def __init__(self, core):
        self.core = core
        self.said = []
        self.samples = 0

    def tell(self, event):
        """Hand one event to the core; return what it commands."""
        commands = self.core.handle(event)
        self.said += commands
        return commands

    def publish(self, now, key="robot/r1/camera", size=1000, red=0.0, **rest):
        self.samples += 1
        event = ev.SamplePublished(
            now,
            self.samples,
            key,
            size,
            rest.pop("t_gen", now),
            rest.pop("origin", None),
            rest.pop("priority", 5),
            {"red": red},
            **rest,
        )
        return self.samples, self.tell(event)

    def want(self, now, robot="op", zid="zz-op", keys=("robot/*/camera",)):
        """Another robot is there and subscribes to the cameras."""
        self.tell(ev.PeerAppeared(now, robot, zid))
        state = State(robot, zid, "enforce", "", (), keys)
        self.tell(ev.StateHeard(now, state, len(pack_state(state))))

    def answer(self, now, decide, *, send, iterations=10):
        """The worker's plan: send the current message or not."""
        sends = (decide.problem.current,) if send else ()
        return self.tell(ev.DecisionReady(now, decide.ticket, Plan(send, sends, 1.0, None, iterations, 10)))

    def all(self, kind):
        return [command for command in self.said if isinstance(command, kind)]


def only(commands, *kinds):
    """Those commands that are of the kinds, without the talk between daemons and the log."""
    kinds = kinds or (Decide, Forward, Drop)
    return [command for command in commands if isinstance(command, kinds)]
