"""A daemon's status as text for people. Its JSON form is made in `proxy.core.status`."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from utility_specs import Specs

Status = Mapping[str, Any]
Row = Sequence[str]

UNKNOWN = "-"
ALONE = "no other robot is on the mesh; samples that nobody there wants stay here and are not counted"

_NOT_MALFORMED = (":other version", ":flood", ":unknown")
_LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
_SMALL = ((1.0, ""), (1e-3, "m"), (1e-6, "μ"))
_PREFIXES = {"s": _SMALL, "J": _SMALL, "messages": ()}


def table(status: Status) -> str:
    """Describe a daemon: what it is, its counts, decisions, budget, streams, features, peers and warnings."""
    parts = [
        _headline(status),
        _counts(status.get("counts", {})),
        _denied(status.get("daemon", {}).get("denied", {})),
        _decisions(status.get("decisions", {})),
        _budget(status.get("budget", ())),
        _streams(status.get("streams", ())),
        _kept(status.get("kept", {})),
        _features(status.get("features", ())),
        ALONE if status.get("peers") == [] else _peers(status.get("peers", ())),
        _warnings(status),
    ]
    return "\n\n".join(part for part in parts if part)


def _headline(status: Status) -> str:
    return "   ".join(
        (
            f"robot {status.get('robot', UNKNOWN)}",
            f"mode {status.get('mode', UNKNOWN)}",
            _specs(status),
            f"coordination {status.get('coordination', UNKNOWN)}",
            f"transport {status.get('transport', UNKNOWN)}",
            f"up {duration(status.get('uptime'))}",
            *([f"sendworthy {status['version']}"] if status.get("version") else []),
        )
    )


def _specs(status: Status) -> str:
    if status.get("specs") == Specs.empty().generation:
        return f"no specs in {status.get('daemon', {}).get('specs', UNKNOWN)}: everything passes"
    return f"specs {status.get('specs', UNKNOWN)}"


def _counts(counts: Status) -> str:
    reasons, sizes = counts.get("by_reason", {}), counts.get("bytes", {})
    law = " + ".join(f"{counts.get(name, 0)} {name}" for name in ("forwarded", "dropped", "queued"))
    rows = [
        ("", reason, str(n), amount(sizes[reason], "B") if reason in sizes else "")
        for reason, n in sorted(reasons.items(), key=lambda pair: -pair[1])
    ]
    return "\n".join([f"samples  {counts.get('in', 0)} in = {law}", *columns(rows, "llrr")])


def _denied(denied: Mapping[str, Status]) -> str:
    """What the rules of the bridge kept from crossing, by direction; nothing when it was nothing."""
    names = ("samples", "queries", "replies", "subscribers", "queryables", "tokens")
    rows = [
        (way, *(str(counts.get(name, 0)) for name in names)) for way, counts in denied.items() if any(counts.values())
    ]
    return _section(("DENIED", *(name.upper() for name in names)), "lrrrrrr", rows)


WITHOUT_SEARCH = {
    "unneeded": "{} more samples went while there was room for all",
    "undisputed": "{} more samples went as they earn what room costs",
    "hopeless": "{} were dropped as they do not earn what room costs",
    "would_drop": "{} would be dropped in enforce",
}
"""What is said of samples on which no search decided alone."""


def _decisions(decisions: Status) -> str:
    """What the searches came to, and why the last one decided so; nothing when there was none."""
    made = decisions.get("made", 0)
    without = [("", text.format(decisions[name])) for name, text in WITHOUT_SEARCH.items() if decisions.get(name)]
    if not (made or without or decisions.get("late")):
        return ""
    each = f", {decisions.get('iterations', 0) / made:.0f} iterations each" if made else ""
    rows = [("decided", f"{made} times{each}"), *without]
    if decisions.get("seconds"):
        longest = duration(decisions.get("longest"))
        rows.append(("time", f"{duration(decisions['seconds'] / made)} each, the longest {longest}"))
    if late := decisions.get("late"):
        rows.append(("", f"{late} were late: they were sent if they fitted"))
    if (thinned := decisions.get("thinned") or {}).get("windows"):
        rows.append(
            ("thinned", f"{thinned['windows']} windows, {thinned['messages']} of {thinned['of']} messages kept")
        )
    if decisions.get("bounded"):
        rows.append(("quality", f"{share(decisions.get('proven'), made)} proven optimal, {_loss(decisions)}"))
    if decisions.get("binding"):
        rows.append(("scarce", ", ".join(f"{name} ({count} drops)" for name, count in decisions["binding"].items())))
    return "\n".join(columns([*rows, *_last(decisions.get("last") or {})], "ll"))


def _loss(decisions: Status) -> str:
    lost = decisions.get("gap", 0.0) / max(decisions.get("utility", 0.0), 1e-9)
    return f"at most {lost:.2%} of the utility lost"


def _last(last: Status) -> list[Row]:
    """The last decision, what spoke for it, what the constraints asked, and what it took."""
    if not last:
        return []
    asked = {name: price for name, price in last.get("prices", {}).items() if price}
    full = [name for name in last.get("binding", ()) if name not in asked]
    worth = f"utility {number(last.get('utility'))}, of the opposite {number(last.get('opposite'))}"
    took = f"{last.get('iterations', 0)} iterations, {last.get('nodes', 0)} nodes, {duration(last.get('seconds'))}"
    asks = [f"{name} asks {number(price)}" for name, price in asked.items()] + [f"{name} is full" for name in full]
    return [
        ("last", f"{last.get('key', UNKNOWN)} {last.get('reason', UNKNOWN)} {duration(last.get('age'))} ago"),
        ("", f"{worth}; lead {number(last.get('lead'))}, gap {number(last.get('gap'))}"),
        *([("", ", ".join(asks))] if asks else []),
        ("", took),
    ]


def _budget(budget: Sequence[Status]) -> str:
    rows = [
        (
            str(limit.get("constraint", UNKNOWN)),
            f"{limit.get('window', 0.0):g} s",
            amount(limit.get("limit"), limit.get("unit", "B")),
            amount(limit.get("held"), limit.get("unit", "B")),
            share(limit.get("held"), limit.get("limit")),
            amount(limit.get("used"), limit.get("unit", "B")),
            share(limit.get("used"), limit.get("limit")),
            str(limit.get("members", 1)),
        )
        for limit in budget
    ]
    return "\n".join(
        line
        for line in (
            _section(("BUDGET", "WINDOW", "LIMIT", "OURS", "", "USED", "", "ROBOTS"), "lrrrrrrr", rows),
            *(_adaptive(limit) for limit in budget if "adaptive" in limit),
        )
        if line
    )


def _adaptive(limit: Status) -> str:
    """How an adaptive limit came to be what it is."""
    adaptive = limit["adaptive"]
    return (
        f"{limit.get('constraint', UNKNOWN)} is adaptive: {share(adaptive.get('in_force'), 1.0)} of its ceiling, "
        f"{share(adaptive.get('estimate'), 1.0)} by our estimate ({adaptive.get('reason', UNKNOWN)}, "
        f"delay {duration(adaptive.get('delay'))})"
    )


def _streams(streams: Iterable[Status]) -> str:
    rows = [
        (
            str(stream.get("key", UNKNOWN)),
            str(stream.get("robot", UNKNOWN)),
            str(stream.get("type", UNKNOWN)),
            schedule(stream),
            duration(stream.get("period") or None),
            amount(stream.get("size"), "B"),
            f"{stream.get('scale', 0.0):.3g}",
            str(stream.get("generated", 0)),
            str(stream.get("forwarded", 0)),
            str(stream.get("generated", 0) - stream.get("forwarded", 0)),
            rate(stream),
            str(stream.get("receivers", 0)),
        )
        for stream in streams
    ]
    head = (
        "STREAM",
        "ROBOT",
        "TYPE",
        "SCHEDULE",
        "PERIOD",
        "SIZE",
        "SCALE",
        "MADE",
        "SENT",
        "UNSENT",
        "SENT/S",
        "WANTED BY",
    )
    return _section(head, "llllrrrrrrrr", rows)


def _kept(kept: Status) -> str:
    """The copies for robots that were away, and what became of them; nothing when there were none."""
    reasons = {"waiting": kept.get("waiting", 0)} | kept.get("by_reason", {})
    law = " + ".join(f"{count} {reason}" for reason, count in reasons.items())
    total = [f"kept  {kept['in']} copies for robots that were away = {law}"] if kept.get("in") else []
    rows = [
        (
            str(each.get("robot", UNKNOWN)),
            "back" if each.get("back") else "away",
            duration(each.get("away")),
            str(each.get("samples", 0)),
        )
        for each in kept.get("for", ())
    ]
    return "\n".join([*total, *(columns([("KEPT FOR", "", "SINCE", "COPIES"), *rows], "llrr") if rows else ())])


def _features(features: Iterable[Status]) -> str:
    """What could not be computed, or not for every sample; nothing when all goes well."""
    rows = [
        (
            str(each.get("feature", UNKNOWN)),
            str(each.get("type", UNKNOWN)),
            str(each.get("failed", 0)),
            str(each.get("held", 0)),
            duration(each.get("cost")),
            duration(each.get("budget")),
        )
        for each in features
        if each.get("failed") or each.get("held")
    ]
    return _section(("FEATURE", "TYPE", "FAILED", "OLD VALUE HELD", "TAKES", "BUDGET"), "llrrrr", rows)


def _peers(peers: Iterable[Status]) -> str:
    rows = [
        (
            str(peer.get("robot", UNKNOWN)),
            str(peer.get("mode") or UNKNOWN) if peer.get("takes_part", True) else "takes no part",
            str(peer.get("version") or UNKNOWN),
            _latency(peer.get("latency_in")),
            _latency(peer.get("latency_out")),
            _percent(peer.get("loss_in")),
            _percent(peer.get("loss_out")),
            duration(peer.get("wall_ahead")),
            duration(peer.get("digest_age")),
            str(peer.get("samples", 0)),
            str(peer.get("received_of_ours", 0)),
        )
        for peer in peers
    ]
    head = ("PEER", "MODE", "VERSION", "FROM IT", "TO IT", "LOST IN", "OUT", "CLOCK", "HEARD", "GOT", "GOT OURS")
    return _section(head, "lllrrrrrrrr", rows)


def _latency(line: Status | None) -> str:
    """What a sample takes: the fixed part, and what a thousand bytes add."""
    if line is None:
        return UNKNOWN
    fixed, per_byte = duration(line.get("fixed")), line.get("per_byte") or 0.0
    return f"{fixed} + {duration(1e3 * per_byte)}/kB" if per_byte else fixed


def _percent(part: float | None) -> str:
    return UNKNOWN if part is None else f"{part:.1%}"


def _warnings(status: Status) -> str:
    found = [str(warning) for warning in status.get("warnings", ())]
    if not all(status.get(ledger, {}).get("conserved", True) for ledger in ("counts", "kept")):
        found.append("the counts do not add up: please report this")
    if status.get("malformed"):
        refused = status.get("refused", {}).items()
        kinds = ", ".join(f"{count} {kind}" for kind, count in refused if not kind.endswith(_NOT_MALFORMED))
        found.append(
            f"{status['malformed']} malformed messages on Sendworthy's keys were ignored" + f" ({kinds})" * bool(kinds)
        )
    if status.get("other_version"):
        found.append(f"{status['other_version']} messages of another version of Sendworthy were not understood")
    if status.get("evicted"):
        found.append(f"{status['evicted']} streams or robots were forgotten: there are too many")
    if status.get("untold"):
        found.append(f"{status['untold']} streams, subscriptions or origins are too many to tell the others")
    if status.get("daemon", {}).get("refused"):
        found.append(f"{status['daemon']['refused']} messages of other robots came faster than they could be taken in")
    if status.get("daemon", {}).get("faults"):
        found.append(f"internal errors: {status['daemon']['faults']}, see the log")
    return "\n".join(f"warning: {warning}" for warning in found)


def _section(head: Row, alignment: str, rows: Sequence[Row]) -> str:
    return "\n".join(columns([head, *rows], alignment)) if rows else ""


def columns(rows: Sequence[Row], alignment: str) -> list[str]:
    """Align columns, "l" left and "r" right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if side == "l" else cell.rjust(width)
            for cell, width, side in zip(row, widths, alignment, strict=True)
        ).rstrip()
        for row in rows
    ]


def duration(seconds: float | None) -> str:
    """Write a time [s] with a unit that suits it."""
    if seconds is None:
        return UNKNOWN
    if abs(seconds) < 1.0:
        return f"{seconds * 1e3:.3g} ms"
    if abs(seconds) < 60.0:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def number(value: float | None) -> str:
    """Write a number with three digits."""
    return UNKNOWN if value is None else f"{value:.3g}"


def amount(value: float | None, unit: str) -> str:
    """Write a quantity with three digits and a decimal prefix; times and energies have small ones, counts none."""
    if value is None:
        return UNKNOWN
    for factor, prefix in _PREFIXES.get(unit, _LARGE):
        if abs(value) >= factor:
            return f"{value / factor:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}"


def share(part: float | None, whole: float | None) -> str:
    """Write a part of a whole in percent."""
    return f"{part / whole:.0%}" if part is not None and whole else UNKNOWN


def schedule(stream: Status) -> str:
    """Write how a stream generates, and how exactly it keeps to that; or that no more is expected of it."""
    if stream.get("over"):
        return "over"
    kind, *rest = str(stream.get("schedule") or UNKNOWN).split()
    if kind == "bursts" and rest:
        return f"bursts of {rest[0]}"
    jitter, period = stream.get("jitter"), stream.get("period")
    return f"{kind} ±{share(jitter, period)}" if kind == "periodic" and jitter is not None and period else kind


def rate(stream: Status) -> str:
    """Write how many samples of a stream were sent per second, as far as its period is known."""
    period, generated = stream.get("period"), stream.get("generated", 0)
    if stream.get("over"):
        return "0"
    return f"{stream.get('forwarded', 0) / generated / period:.2g}" if period and generated else UNKNOWN
