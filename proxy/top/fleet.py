"""Who is in the fleet: each robot once, by what itself says where it answers, else as another one sees it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from proxy.quantities import Status
from proxy.top.rates import Change

Changes = Mapping[str, Change]
"""What daemons say, by the ids of their sessions on the mesh."""


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot: its `name` as it is shown and as it was `told`, what is known of it, and whether it said so itself."""

    name: str
    told: str
    zid: str
    by: Change
    itself: bool

    @property
    def called(self) -> str:
        """Its name in what is known of it: that of a robot which came later has a part of its id behind it."""
        return str((self.peer or self.by.now).get("robot", self.name))

    @property
    def peer(self) -> Status:
        """What another one says of it; nothing if it is the one who speaks."""
        return {} if self.itself else next((p for p in self.by.now.get("peers", ()) if p.get("zid") == self.zid), {})

    def streams(self) -> list[dict[str, Any]]:
        """Return the streams that it publishes."""
        return [each for each in self.by.streams() if each.get("robot") == self.called]


def robots(changes: Changes) -> list[Robot]:
    """Return all robots, by name. Those of one name have a part of their id behind it."""
    found = {zid: (_own_name(str(change.now.get("robot")), zid), change, True) for zid, change in changes.items()}
    for change in changes.values():
        for peer in change.now.get("peers", ()):
            zid = str(peer.get("zid"))
            found.setdefault(zid, (_own_name(str(peer.get("robot")), zid), change, False))
    names = [name for name, _, _ in found.values()]
    shown = {zid: f"{name} ({zid[:4]})" if names.count(name) > 1 else name for zid, (name, _, _) in found.items()}
    named = [Robot(shown[zid], name, zid, change, itself) for zid, (name, change, itself) in found.items()]
    return sorted(named, key=lambda robot: robot.name)


def namesakes(found: Iterable[Robot]) -> list[str]:
    """Return the names that several robots have."""
    names = [robot.told for robot in found]
    return sorted({name for name in names if names.count(name) > 1})


def _own_name(name: str, zid: str) -> str:
    """Return what a robot calls itself: where its name was taken, others put a part of its id behind it."""
    return name.removesuffix(f"-{zid[:4]}")


def rows(found: Iterable[Robot]) -> Iterator[dict[str, Any]]:
    """Yield a row for each robot: sums over its streams, and how it stands to who speaks of it."""
    for robot in found:
        streams, now, peer = robot.streams(), robot.by.now, robot.peer
        told: Status = now if robot.itself else peer
        yield {
            "robot": robot.name,
            "mode": told.get("mode"),
            "takes_part": told.get("takes_part", True),
            "version": told.get("version"),
            "streams": len(streams),
            **{name: _sum(streams, name) for name in ("made", "sent", "unsent", "bytes")},
            "age": max((each["age"] for each in streams if each.get("age") is not None), default=None),
            "latency_out": peer.get("latency_out"),
            "loss_out": peer.get("loss_out"),
            "wall_ahead": peer.get("wall_ahead"),
            "digest_age": peer.get("digest_age"),
            "seen_by": "itself" if robot.itself else str(now.get("robot")),
        }


def _sum(streams: Iterable[Mapping[str, Any]], name: str) -> float | None:
    known = [each[name] for each in streams if each.get(name) is not None]
    return sum(known) if known else None
