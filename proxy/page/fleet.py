"""What the page shows of the fleet, from what daemons say: the same reading as that of `sendworthy top`."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any

from proxy.decisions_text import FATES
from proxy.page.frames import Delay
from proxy.page.specs import InForce
from proxy.page.worth import Worth, marked, worth
from proxy.quantities import Status
from proxy.status.warnings import warnings
from proxy.top.fleet import Robot, namesakes, robots
from proxy.top.frames import Scene

NUMBERS = ("made", "sent", "unsent", "bytes", "generated", "forwarded")


def described(scene: Scene, in_force: InForce, rates: Mapping[str, float], name: str) -> dict[str, Any]:
    """Return all that is shown, as plain JSON data; `name` is the robot through whose daemon the page looks."""
    found = robots(scene.changes)
    told = [_robot(robot, in_force) for robot in found]
    own = next((change.now for change in scene.changes.values() if change.now.get("robot") == name), {})
    worths = [each["worth"] for robot in told for each in robot["types"]]
    return {
        "kind": "status",
        "by": name,
        "away": scene.away,
        "specs": in_force.generation,
        "problem": in_force.problem,
        "robots": told,
        "streams": [each for robot in found for each in _streams(robot, in_force, rates)],
        "limits": [_limit(each) for each in own.get("budget", ())],
        "worth": _total(worths),
        "warnings": _warnings(found),
    }


def delays(scene: Scene, name: str) -> dict[str, Delay]:
    """Return what the daemon of the robot `name` knows of the ways of samples to it, by their keys."""
    own = next((change.now for change in scene.changes.values() if change.now.get("robot") == name), {})
    peers = {str(peer.get("robot")): peer for peer in own.get("peers", ())}
    return {
        str(stream.get("key")): _delay(peers.get(str(stream.get("robot")), {})) for stream in own.get("streams", ())
    }


def _delay(peer: Status) -> Delay:
    way = peer.get("latency_in") or {}
    return Delay(peer.get("wall_ahead"), way.get("fixed", 0.0), way.get("per_byte", 0.0))


def _robot(robot: Robot, in_force: InForce) -> dict[str, Any]:
    told: Status = robot.by.now if robot.itself else robot.peer
    streams = sorted(robot.streams(), key=lambda each: str(each.get("type")))
    return {
        "robot": robot.name,
        "called": robot.called,
        "zid": robot.zid,
        "itself": robot.itself,
        "seen_by": str(robot.by.now.get("robot")),
        "mode": told.get("mode"),
        "takes_part": told.get("takes_part", True),
        "version": told.get("version"),
        "types": [
            _type(kind, list(each), in_force, itself=robot.itself)
            for kind, each in groupby(streams, key=lambda each: str(each.get("type")))
        ],
    }


def _type(kind: str, streams: Sequence[dict[str, Any]], in_force: InForce, *, itself: bool) -> dict[str, Any]:
    """What becomes of the samples of a type from one robot: its streams together."""
    reasons: dict[str, float] = {}
    for stream in streams:
        for reason, rate in stream["why"].items():
            reasons[reason] = reasons.get(reason, 0.0) + rate
    return {
        "type": kind,
        "keys": [str(each.get("key")) for each in streams],
        **{number: _sum(streams, number) for number in NUMBERS},
        "age": max((each["age"] for each in streams if each.get("age") is not None), default=None),
        "why": [
            {"reason": reason, "rate": rate, "words": FATES.get(reason, reason)} for reason, rate in reasons.items()
        ],
        "why_known": itself,
        "worth": _total([_worth(in_force, each) for each in streams]),
    }


def _streams(robot: Robot, in_force: InForce, rates: Mapping[str, float]) -> Iterable[dict[str, Any]]:
    """What the pictures of a robot need: whose they are, how often they come, and whether one is to be marked."""
    for stream in robot.streams():
        key = str(stream.get("key"))
        yield {"key": key, "robot": robot.name, "rate": rates.get(key), "marked": marked(in_force.specs, stream)}


def _worth(in_force: InForce, stream: Status) -> dict[str, float] | None:
    found: Worth | None = worth(in_force.specs, stream)
    return None if found is None else {"now": found.now, "most": found.most}


def _total(worths: Sequence[Mapping[str, float] | None]) -> dict[str, float] | None:
    """Return the sum of what is known; None where nothing is."""
    known = [each for each in worths if each is not None]
    return {name: sum(each[name] for each in known) for name in ("now", "most")} if known else None


def _limit(limit: Status) -> dict[str, Any]:
    names = ("constraint", "unit", "window", "limit", "used", "used_by_all", "price_per_kb", "adaptive")
    return {name: limit.get(name) for name in names}


def _warnings(found: Sequence[Robot]) -> list[str]:
    same = [f"several robots are called {name}: rename all but one" for name in namesakes(found)]
    return [*same, *(f"{robot.name}: {each}" for robot in found if robot.itself for each in warnings(robot.by.now))]


def _sum(streams: Iterable[Status], name: str) -> float | None:
    known = [each[name] for each in streams if each.get(name) is not None]
    return sum(known) if known else None
