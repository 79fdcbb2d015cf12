"""Robots that have been met, and what they say."""

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, Echo, State, StreamState
from proxy.core.view.view import SharedView

CAMERA = "robot/r2/camera"


def digest(sent, *streams, echoes=()):
    """One of robot r2, which was sent then on its clock."""
    return Digest("r2", "z-r2", sent, 0, 0, streams, echoes)


def meet(view, **rest):
    """Robot r2 is there and told us of its camera, number 7."""
    view.add_peer(0.0, "r2", "z-r2")
    streams = (StreamState(7, CAMERA, "camera", 0.5), StreamState(8, "other/key", "x", 0.5))
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", streams, **rest))


def join(view, robot, **rest):
    """A robot is there that wants all cameras, by the same specs as ours."""
    view.add_peer(0.0, robot, f"z-{robot}")
    state = State(robot, f"z-{robot}", "enforce", view.specs.generation, (), ("robot/**",), **rest)
    view.heard_state(0.0, state)


def team(specs):
    """The view of robot r1; robots r2, r3 and r4 want all cameras, as r1 does."""
    view = SharedView(CoreSettings("r1", "z-r1"), specs)
    view.subscribers.set_own(("robot/**",))
    for robot in ("r2", "r3", "r4"):
        join(view, robot)
    return view


def lose(peer, sent, received):
    """Of so many samples only so many come to a robot, as it tells."""
    for at, out, came in ((1.0, 0, 0), (2.0, sent, received)):
        peer.outbound.sent = out
        peer.outbound.sent_digest(at)
        peer.outbound.heard_echo(at, Echo("z-r1", at, at, came, 0.0))
