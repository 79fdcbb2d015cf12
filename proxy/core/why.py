"""The core's part of `sendworthy why`: plain JSON data. Times are ages or durations [s], sizes are bytes."""

from typing import Any

from planner import Plan
from planner.utility import integral
from proxy.core.market.standing import Weighed
from proxy.core.model.waiting import Waiting
from proxy.core.parts import Parts
from proxy.core.samples.decision_log import Entry, Rival, Searched
from proxy.core.samples.decisions import is_proven
from proxy.core.view.stream import Stream


def stream_decisions(core: Parts, now: float, key: str, last: int, after: int) -> dict[str, Any]:
    """Return the last decisions on our stream of a key, the oldest first, and what is undecided of it."""
    robot, log = core.settings.robot, core.gate.decisions.log
    stream, entries = core.view.streams.known(robot, key), log.of(key)
    share = _share(core, now, stream)
    return {
        "robot": robot,
        "key": key,
        "type": None if stream is None else stream.information_type.name,
        "mode": core.gate.appraisal.mode_of(stream).value,
        "receivers": 0 if stream is None else core.view.subscribers.count(stream),
        "generated": 0 if stream is None else stream.generated,
        "forwarded": 0 if stream is None else stream.forwarded,
        "by_reason": {} if stream is None else dict(sorted(stream.fates.items())),
        "undecided": _undecided(core, now, key),
        "decisions": [_entry(core, now, stream, share, each) for each in entries if each.number > after][-last:],
    }


def _share(core: Parts, now: float, stream: Stream | None) -> float:
    """Return how often a sample of a stream counts; of one that is unknown, or was only deleted yet, none does."""
    if stream is None or stream.last is None:
        return 0.0
    return sum(each.share for each in core.view.audiences.of(now, stream).receivers)


def _undecided(core: Parts, now: float, key: str) -> list[dict[str, Any]]:
    deciding = {each.sample for each in core.gate.search.deciding()}
    return [
        {
            "age": now - each.t_gen,
            "size": each.size,
            "deciding": each.sample in deciding,
            "opens_in": None if opens_at is None else max(0.0, opens_at - now),
        }
        for each, opens_at in core.gate.undecided_of(key)
    ]


def _entry(core: Parts, now: float, stream: Stream | None, share: float, entry: Entry) -> dict[str, Any]:
    why, sample = entry.why, entry.sample
    held = None if sample is None else max(0.0, entry.until - sample.t_gen)
    return {
        "number": entry.number,
        "nth": entry.nth,
        "count": entry.count,
        "age": now - entry.until,
        "first_age": now - entry.since,
        "reason": why.reason,
        "sent": entry.shadowed or not why.reason.startswith(("dropped:", "waits")),
        "shadowed": entry.shadowed,
        "cause": str(why.cause),
        "lacking": list(why.lacking),
        "beside": why.beside,
        "copy_to": _robot(core, entry.to),
        "size": None if sample is None else sample.size,
        "decided_at_age": held,
        "worth": _worth(stream, share, sample) if why.searched is None else why.searched.this.worth,
        "market": None if why.weighed is None else _market(why.weighed),
        "search": None if why.searched is None else _search(why.searched),
    }


def _robot(core: Parts, to: str) -> str | None:
    """Return the name of a robot, or its tag if it is not here; None for nobody."""
    peer = core.view.peers.get(to)
    return peer.robot if peer is not None else to or None


def _worth(stream: Stream | None, share: float, sample: Waiting | None) -> float | None:
    """Return what a sample is worth to all who want it in its first second [utility·s], as far as that is known."""
    if stream is None or sample is None:
        return None
    return sample.scale * share * integral(stream.information_type.utility_of(sample.features), 1.0)


def _market(weighed: Weighed) -> dict[str, Any]:
    """What the room of a sample costs, and what its stream earns [utility·s], and how often it should send [s]."""
    return {
        "standing": weighed.standing.value,
        "price": weighed.cost,
        "least": weighed.least,
        "most": weighed.most,
        "every": weighed.apart if weighed.apart < float("inf") else None,
        "interval": weighed.interval,
    }


def _search(searched: Searched) -> dict[str, Any]:
    plan = searched.plan
    with_it, without, lead = _compared(plan)
    return {
        "send": plan.send,
        "with": with_it,
        "without": without,
        "difference": None if with_it is None or without is None else with_it - without,
        "lead": lead,
        "earns": plan.earns,
        "ends": searched.ends,
        "price": sum(plan.prices),
        "prices": dict(zip(searched.constraints, plan.prices, strict=False)),
        "binding": list(plan.binding),
        "gap": plan.gap,
        "proven": is_proven(plan),
        "iterations": plan.iterations,
        "allowed": searched.asked,
        "cut": searched.cut,
        "nodes": plan.nodes,
        "seconds": plan.seconds,
        "messages": searched.held,
        "messages_of": max(searched.full, searched.held),
        "own": _rival(searched.this),
        "competitors": [_rival(each) for each in sorted(searched.rivals, key=lambda r: -r.worth / max(r.size, 1))],
        "more": searched.more,
    }


def _compared(plan: Plan) -> tuple[float | None, float | None, float | None]:
    """Return what the best plans with and without the sample are worth, and by how much the former exceeds."""
    if not plan.send:
        return plan.opposite, plan.utility, None if plan.lead is None else -plan.lead
    lead = min((each for each in (plan.lead, plan.earns) if each is not None), default=None)
    found = plan.opposite if lead == plan.lead else plan.spared
    return plan.utility, found, lead


def _rival(rival: Rival) -> dict[str, Any]:
    names = "robot", "key", "worth", "size", "messages", "sent"
    return {name: getattr(rival, name) for name in names}
