"""The core's part of `sendworthy status`: plain JSON data."""

import math
from collections import Counter
from collections.abc import Collection, Mapping
from typing import Any

from proxy.core.market.glance import Glance, price_of_kilobyte
from proxy.core.parts import Parts
from proxy.core.protocol.envelope import VERSION
from proxy.core.protocol.messages import tag
from proxy.core.transit.latency import Latency
from proxy.core.view.peer import Peer
from proxy.core.view.stream import Stream
from proxy.core.view.warnings import (
    cast_warnings,
    digest_warnings,
    mode_warnings,
    namesake_warnings,
    transport_warnings,
)
from utility_specs import InformationType

LIVE = (
    *("robot", "key", "type", "size", "scale", "shown", "generated", "forwarded", "by_reason", "receivers", "age"),
    "last_generated",
)
"""What changes of a stream with each sample, and what it is called."""
STATUS_VERSION = 1
"""Rises when a field is renamed, goes, or means something else; not when one is added."""
OTHER_VERSION = ":other version"
UNDERSTOOD = (OTHER_VERSION, ":flood", ":unknown", ":unproved")
"""How kinds of what was refused and is not malformed end."""


def report(
    core: Parts, refused: Mapping[str, int], retained: Collection[str], now: float, *, uptime: float
) -> dict[str, Any]:
    """All that the core knows but for its streams, by topic, as ages or durations [s] and bytes.

    `refused` counts what was heard and changed nothing, `retained` is what is taken from apps whoever is here.
    """
    return {
        "status_version": STATUS_VERSION,
        "robot": core.settings.robot,
        "version": core.settings.version,
        "wire_version": VERSION,
        "zid": core.settings.zid,
        "mode": core.gate.appraisal.mode.value,
        "specs": core.view.specs.generation,
        "coordination": "split" if core.coordination.team.splits else "announce",
        "transport": core.settings.transport,
        "wall_error": core.view.clocks.error or None,
        "uptime": uptime,
        "counts": _counts(core),
        "kept": _kept(core, now) | {"keys": sorted(retained)},
        "decisions": core.gate.decisions.described(now),
        "budget": _budget(core, now),
        "on_air": {"messages": core.view.traffic.messages, "bytes": core.view.traffic.bytes},
        "digests": core.gossip.account.described(),
        "streams": [],
        "features": [row for each in core.view.specs.types for row in _features(each)],
        "peers": [_peer(peer, core, now) for peer in core.view.peers.values()],
        "warnings": [
            *namesake_warnings(core.settings, core.view.peers),
            *transport_warnings(core.settings, core.view.peers),
            *mode_warnings(core.gate.appraisal.mode, core.view.peers, core.budget.limits),
            *core.mismatched.warnings(),
            *cast_warnings(core.budget.limits, core.settings.transport),
            *digest_warnings(core.budget.limits, core.view.members.speaking + 1),
            *core.view.clocks.warnings(),
            *core.channel.capacity.warnings(),
        ],
        "malformed": sum(count for kind, count in refused.items() if not kind.endswith(UNDERSTOOD)),
        "other_version": sum(count for kind, count in refused.items() if kind.endswith(OTHER_VERSION)),
        "refused": dict(sorted(refused.items())),
        "evicted": core.view.evicted
        + core.unknown_senders.forgotten
        + sum(p.evicted for p in core.view.peers.values())
        + sum(each.paces.evicted for each in core.view.specs.types),
        "untold": core.gossip.states.left_out,
        "asked": core.gossip.requests.asked,
    }


def streams(core: Parts, now: float) -> list[dict[str, Any]]:
    """Return what is known of each stream."""
    glance = Glance(core.view, now)
    return [_stream(core, stream, glance, now) for stream in core.view.streams]


def live_streams(core: Parts, now: float) -> dict[str, Any]:
    """Return what changes of each stream, as `rows` under `columns`: a third of the text, in half of the time."""
    glance = Glance(core.view, now)
    rows = [_live(stream, glance, now, *glance.wanted(stream)) for stream in core.view.streams]
    return {"columns": LIVE, "rows": rows}


def types(core: Parts) -> dict[str, dict[str, Any]]:
    """Return what became of our samples by information type: that takes little."""
    own = Counter(stream.information_type.name for stream in core.view.streams.own())
    found: dict[str, dict[str, Any]] = {
        name: {"streams": own[name], "generated": core.counts.generated[name], "by_reason": {}}
        for name in sorted({*own, *core.counts.generated, *(name for name, _ in core.counts.decided)})
    }
    for (name, reason), count in sorted(core.counts.decided.items()):
        found[name]["by_reason"][reason] = count
    return found


def _kept(core: Parts, now: float) -> dict[str, Any]:
    """Return what is kept for robots that are away, and who they are."""
    copies = core.kept.copies
    return {
        "in": copies.entered,
        "waiting": copies.waiting,
        "bytes": copies.payloads.bytes,
        "conserved": copies.conserved,
        "by_reason": dict(sorted(copies.by_reason.items())),
        "for": [
            {"robot": away.robot.name, "back": away.back, "away": now - away.since, "samples": away.count}
            for away in copies
        ],
    }


def _counts(core: Parts) -> dict[str, Any]:
    counts = core.counts
    return {
        "in": counts.received,
        "forwarded": counts.forwarded,
        "dropped": counts.dropped,
        "queued": counts.queued,
        "conserved": counts.conserved,
        "by_reason": dict(sorted(counts.by_reason.items())),
        "bytes": {reason: size for reason, size in sorted(counts.bytes.items()) if size},
    }


def _budget(core: Parts, now: float) -> list[dict[str, Any]]:
    prices = core.gate.appraisal.last_prices(now)
    if prices is None:
        budget = core.budget
        prices = Glance(core.view, now).prices(budget.usable(now), alone=budget.alone, turns=budget.turns)
    adaptive = [k for k, limit in enumerate(core.budget.limits) if limit.least < 1.0]
    return [
        {
            "constraint": limit.name,
            "kind": limit.measure.kind,
            "unit": limit.measure.unit,
            "window": limit.window,
            "limit": limit.limit,
            "held": core.budget.whole(now, k),
            "used": core.budget.used(now, k),
            "used_by_all": core.budget.used(now, k) + core.view.traffic.used(now, limit),
            "price": prices[k],
            "price_per_kb": price_of_kilobyte(limit, prices[k]),
            "members": 1 + len(core.view.peers) if limit.shared else 1,
            **({"adaptive": core.channel.capacity.described(now, adaptive.index(k))} if k in adaptive else {}),
        }
        for k, limit in enumerate(core.budget.limits)
    ]


def _stream(core: Parts, stream: Stream, glance: Glance, now: float) -> dict[str, Any]:
    sent, (count, latency) = stream.sent, glance.wanted(stream)
    return {
        **dict(zip(LIVE, _live(stream, glance, now, count, latency), strict=True)),
        "schedule": stream.schedule.kind,
        "period": stream.schedule.period,
        "jitter": stream.schedule.jitter,
        "forecast": stream.forecasts,
        "over": _over(stream, core.view.staleness.known_until(now, stream)),
        "latency": latency,
        "last_forwarded": now - sent.t_sent if sent else None,
    }


def _over(stream: Stream, until: float) -> bool:
    """Whether it seems to be over by then: its schedule knows of no samples that are overheard, and not told of."""
    heard = stream.last.t_gen if stream.last else -math.inf
    return stream.schedule.over(until) and until - heard >= stream.schedule.timeout


def _live(stream: Stream, glance: Glance, now: float, count: int, latency: float | None) -> tuple[Any, ...]:
    """Return the values of `LIVE`; so many robots want the stream, and its samples take so long to them."""
    fates, last, there = stream.fates, stream.last, glance.there(stream, latency)
    generated, forwarded = stream.generated, stream.forwarded
    return (
        stream.robot,
        stream.key,
        stream.information_type.name,
        last.size if last else 0,
        last.scale if last else 0.0,
        there.scale if there else None,
        max(forwarded, generated),  # what is heard from the air digests tell of later
        forwarded,
        dict(sorted(fates.items())) if len(fates) > 1 else dict(fates),
        count,
        now - there.t_gen if there else None,
        now - last.t_gen if last else None,
    )


def _features(each: InformationType) -> list[dict[str, Any]]:
    """What is computed from samples of a type and what it takes, and how often a default or an older value held."""
    failed, held, costs = each.failures.counts(), each.paces.held(), each.paces.costs()
    budgets = {name: feature.budget for name, feature in each.features}
    others = [name for name in failed if name not in budgets]  # the scale, a utility, forecasts
    return [
        {
            "type": each.name,
            "feature": name,
            "failed": failed.get(name, 0),
            "held": held.get(name, 0),
            "cost": costs.get(name),
            "budget": budgets.get(name),
        }
        for name in (*budgets, *others)
    ]


def _peer(peer: Peer, core: Parts, now: float) -> dict[str, Any]:
    known, ahead = peer.offset.known, core.view.clocks.ahead(peer)
    return {
        "robot": peer.robot,
        "zid": peer.zid,
        "mode": peer.state.mode,
        "transport": peer.state.transport,
        "version": peer.state.version or None,
        "wire_version": peer.wire or None,
        "takes_part": tag(peer.zid) not in core.mismatched.found,
        "specs": peer.state.specs,
        "latency_in": _latency(peer.inbound.latency),
        "latency_out": _latency(peer.outbound.latency),
        "loss_in": peer.inbound.losses.share,
        "loss_out": peer.outbound.losses.share,
        "clock_offset": peer.offset.offset,
        "clock_uncertainty": peer.offset.uncertainty(now) if known else None,
        "clock_jumps": peer.offset.jumps,
        "wall_ahead": ahead,
        "wall_error": peer.clock_error or None,
        "digest_age": now - peer.digest_received if peer.digest else None,
        "samples": peer.inbound.samples,
        "implausible": peer.inbound.implausible,
        "received_of_ours": peer.outbound.received,
        "sent": peer.outbound.sent,
    }


def _latency(line: Latency | None) -> dict[str, float] | None:
    """What samples take: a fixed part [s], and one per byte [s/B]."""
    return None if line is None else {"fixed": line.fixed, "per_byte": line.per_byte}
