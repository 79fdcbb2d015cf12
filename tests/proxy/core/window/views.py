"""Views of a few streams, from which the tests build windows."""

from planner import SearchSettings, start
from planner.measures import Throughput
from proxy.core.model.limits import Limit, Limits
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.messages import State
from proxy.core.view.stream import Generated
from proxy.core.view.view import SharedView

LIMIT = Limit("throughput", 1.0, 4_000.0, Throughput(4_000.0, 1.0))

BY_RED = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }
features.red = { kind = "color_fraction", color = "red", default = 0.5 }
"""

MODEL = '{ python = "tests.utility_specs.models:Everything" }'


def make_view(specs, **settings):
    return SharedView(CoreSettings("r1", "z-r1", **settings), specs)


def add_stream(view, robot, *, period=0.5, scale=1.0, size=1000, until=10.0, key=None):
    """A wanted stream that generated from 5 s to `until`."""
    stream = view.streams.touch(until, robot, key or f"robot/{robot}/camera")
    stream.matching = True
    for count in range(int((until - 5.0) / period) + 1):
        stream.note_generated(count + 1, Generated(5.0 + count * period, size, scale))
    return stream


def sample(t_gen, key="robot/r1/camera", scale=1.0, number=1):
    return Waiting(number, key, 1000, t_gen, scale, 5, markovian=True)


def union(sent=()):
    return Limits((LIMIT,), sent)


def aggregated(make_specs, aggregation, **settings):
    """Our stream of samples that combine so, which r2 wants."""
    view = make_view(make_specs(text=BY_RED + f"aggregation = {aggregation}\n"), **settings)
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",)))
    return view, add_stream(view, "r1", period=0.1)


def meet(view, latency):
    """Robot r2 is there, wants everything, and gets our samples after `latency`."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",)))
    view.peers["z-r2"].outbound.latency = latency
    return view.peers["z-r2"]


def plan_of(problem):
    search = start(problem, SearchSettings())
    search.run(300)
    return search.plan()
