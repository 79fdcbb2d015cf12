"""Key expressions: which cross, and those of Sendworthy itself."""

from collections.abc import Mapping
from typing import Any

import zenoh

PREFIX = "@sendworthy"

OF_PLUGINS = ("@/*/@ros2_lv/**", "@/*/@mavlink/**")
"""What Zenoh's bridges for DDS and MAVLink tell each other of."""

CROSSING = ("**", "**/@adv/**", "@ros2_lv/**", *OF_PLUGINS)
"""What crosses when it cannot be followed who subscribes to what: keys without verbatim chunks, which `**` matches,
those of advanced pub/sub and of ROS 2, and those of bridges."""

INGRESS = ("*/**", "**/@adv/*/**", "@ros2_lv/*/**")
"""The same for samples on the app side, in words that few apps use: so our own subscriptions are told from an app's
`**`. Of bridges only the tokens have such keys."""

ON_AIR = "sendworthy-broadcast-sample"
"""Above the keys of all samples that are broadcast."""

LONGEST = 65_535
"""Zenoh's longest key [B]. A panic ends the thread that publishes on a longer one."""

_ON_AIR = tuple(map(zenoh.KeyExpr, INGRESS))

ANNOUNCED: Mapping[str, Any] = {
    "priority": zenoh.Priority.INTERACTIVE_HIGH,
    "congestion_control": zenoh.CongestionControl.DROP,
    "express": True,
    "allowed_destination": zenoh.Locality.REMOTE,
}
"""How daemons publish what they tell each other."""

ALL_DIGESTS = f"{PREFIX}/*/digest/*"
ALL_STATES = f"{PREFIX}/*/state/*"
ALL_ALIVE = f"{PREFIX}/*/alive/*"
ALL_AT_APPS = f"{PREFIX}/*/app/*"


def fits(key: str) -> bool:
    """Whether Zenoh takes a key as long as this."""
    return len(key.encode()) <= LONGEST


def on_air(key: str) -> bool:
    """Whether samples of `key` can be broadcast: it is longer there, and who listens names verbatim chunks."""
    if not fits(f"{ON_AIR}/{key}"):
        return False
    return "@" not in key or any(expression.intersects(key) for expression in _ON_AIR)


def digest(robot: str, tag: str) -> str:
    """Where the `robot` with this tag publishes its digests."""
    return f"{PREFIX}/{robot}/digest/{tag}"


def kept(to: str, key: str) -> str:
    """Where copies of samples of `key` go that were kept for the robot with the tag `to`.

    Verbatim chunks are escaped, which no `**` matches.
    """
    return f"{PREFIX}/{to}/kept/{key.replace('%', '%25').replace('@', '%40')}"


def backlog(to: str, tag: str) -> str:
    """Where the robot with this `tag` tells the one with the tag `to` of which keys copies wait for it."""
    return f"{PREFIX}/{to}/backlog/{tag}"


def kept_of(key: str) -> str:
    """Return the key of the sample of which something on such a key is a copy; nothing where it is none.

    What is put on `@sendworthy/**` comes to whoever listens for copies, too.
    """
    _, _, kind, copied = (*key.split("/", 3), "", "", "")[:4]
    return copied.replace("%40", "@").replace("%25", "%") if kind == "kept" else ""


def state(robot: str, tag: str) -> str:
    """Where the `robot` with this tag publishes its state and answers queries for it."""
    return f"{PREFIX}/{robot}/state/{tag}"


def alive(robot: str, zid: str) -> str:
    """Return the presence token of `robot` with the mesh session `zid`."""
    return f"{PREFIX}/{robot}/alive/{zid}"


def at_apps(robot: str, zid: str) -> str:
    """Return the token that a daemon shows on the app side alone, with its app session `zid`."""
    return f"{PREFIX}/{robot}/app/{zid}"


def marker(zid: str) -> str:
    """Return where markers of the main session `zid` travel, and those of its mirror session."""
    return f"{PREFIX}/trial/{zid}/marker"


def status(robot: str) -> str:
    """Where the daemon answers its own robot with its status (app side only)."""
    return f"{PREFIX}/{robot}/status"


def mode(robot: str) -> str:
    """Where the daemon takes a new mode (app side only)."""
    return f"{PREFIX}/{robot}/mode"


def profile(robot: str) -> str:
    """Where the daemon is asked for a profile (app side only)."""
    return f"{PREFIX}/{robot}/profile"


def specs(robot: str) -> str:
    """Where the daemon tells the specs in force (app side only)."""
    return f"{PREFIX}/{robot}/specs"


def record(robot: str) -> str:
    """Where the daemon is told to record, and asked what it does (app side only)."""
    return f"{PREFIX}/{robot}/record"


def why(robot: str) -> str:
    """Where the daemon is asked for its last decisions (app side only)."""
    return f"{PREFIX}/{robot}/why"


def fleet(robot: str, order: str) -> str:
    """Where the `robot` takes an order that is meant for all robots (mesh side)."""
    return f"{PREFIX}/{robot}/fleet/{order}"


def to_fleet(robot: str, order: str) -> str:
    """Where the daemon takes an order to pass it on to all robots (app side only)."""
    return f"{PREFIX}/{robot}/to-fleet/{order}"


def robot_of(key: str) -> str:
    """Return the robot of a Sendworthy key."""
    return key.split("/", 2)[1]


def zid_of(key: str) -> str:
    """Return the mesh session of a presence token, or its tag in the key of a digest or a state."""
    return key.rsplit("/", 1)[1]


def crosses(expression: str) -> bool:
    """Whether declarations on `expression` are mirrored: all but ours and those of Zenoh's admin space.

    Through connected routers an app can ask another robot's router for its admin space. Here it does not cross: a
    router that answers while something is declared to it blocks for ever, and no robot should do that to another. What
    plugins of Zenoh declare below a verbatim chunk of their own there, such as the tokens of a bridge for ROS 2 over
    DDS, no router answers for.
    """
    chunks = expression.split("/")
    if PREFIX in chunks:
        return False
    return "@" not in chunks or (chunks[0] == "@" and "@" not in chunks[1:] and "".join(chunks[2:3]).startswith("@"))
