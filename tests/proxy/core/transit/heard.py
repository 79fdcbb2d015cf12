"""What is heard of robot r2: its clock shows 100 s less than ours, its wall clock 1,000 s more than its own."""

from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest

KEY = "robot/r2/camera"


def state(wall_offset, mode="enforce"):
    return State("r2", "z-r2", mode, "", wall_offset=wall_offset)


def hear_digest(peer, at):
    """It was sent at `at` on our clock, and echoes one that we sent then."""
    peer.heard_digest(at + 0.01, Digest("r2", "z-r2", at - 100.0, 0, 0))
    peer.outbound.heard_echo(at + 0.01, Echo("z-r1", at, at - 100.0 + 0.01, 0, 0.0))
    peer.inbound.heard_digest(at + 0.01, at - 100.0, 150)


def hear(peer, sent, took, size=100, error=0.0):
    """A sample stamped at `sent` on our clock."""
    peer.inbound.heard_sample(sent + took, KEY, size, sent - 100.0 + 1000.0 + error)


def news(generated, forwarded, t_generated, t_forwarded):
    return StreamDigest(7, generated, forwarded, t_generated - 100.0, t_forwarded - 100.0, 100, 1.0)
