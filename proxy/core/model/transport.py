"""How samples travel between robots, as they tell each other: `unicast`, or `broadcast` and the multicast group."""

UNICAST = "unicast"
"""A sample is sent once to each robot that wants it."""
_BROADCAST = "broadcast"


def broadcast(group: str) -> str:
    """Name the transport that sends a sample once, to all on a multicast group."""
    return f"{_BROADCAST} {group}"


def is_broadcast(transport: str) -> bool:
    """Whether one transmission reaches all."""
    return transport.startswith(_BROADCAST)
