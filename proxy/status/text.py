"""A daemon's status as text for people, as wide as their terminal."""

import textwrap
from collections.abc import Iterator, Mapping, Sequence

from proxy.printable import clean
from proxy.quantities import UNKNOWN, Status, amount, columns, duration, number, share
from proxy.status.columns import Table, fitted
from proxy.status.tables import DENIED, FEATURES, KEPT, LIMITS, PEERS, STREAMS, failing
from proxy.status.warnings import warnings
from proxy.status.words import reason
from utility_specs import Specs

ALONE = "no other robot is on the mesh; samples that nobody there wants stay here and are not counted"
OTHERWISE = "other specs than here: {}"
"""Said where robots decide by specs of their own, as those that were off when specs were pushed."""
SHADOWED = "mode shadow: all samples go; SENT and NOT SENT are what enforce would do"
"""Said where a stream has samples that are not sent, although all are."""
BETWEEN = "   "
LEAST_TOLD = 20
"""What is told behind something else has so many columns at least."""
WITHOUT_SEARCH = {
    "unneeded": "{} more samples went while there was room for all",
    "certain": "{} more samples went as they are small, and others left them little room",
    "undisputed": "{} more samples went as they earn what room costs",
    "hopeless": "{} were dropped as they do not earn what room costs",
    "would_drop": "{} would be dropped in enforce",
}
"""What is said of samples on which no search decided alone."""


def text(status: Status, width: int | None = None) -> str:
    """Describe a daemon: what it is, what is wrong, and what it does, in lines of this width if there is one."""
    left_out = list[str]()

    def section(table: Table, rows: Sequence[Status]) -> list[str]:
        if not rows:
            return []
        fits = fitted(table, rows, width)
        left_out.extend(fits.left_out)
        return fits.lines()

    peers = status.get("peers", ())
    denied = [
        {"way": way} | dict(counts)
        for way, counts in status.get("daemon", {}).get("denied", {}).items()
        if any(counts.values())
    ]
    parts = [
        headline(status, width),
        [line for warning in warnings(status) for line in wrapped(f"warning: {clean(warning)}", width, "  ")],
        _counts(status.get("counts", {}), width),
        section(DENIED, denied),
        [*section(LIMITS, status.get("budget", ())), *_adaptive(status.get("budget", ()), width)],
        _decisions(status.get("decisions", {}), width),
        [*(wrapped(SHADOWED, width) if status.get("mode") == "shadow" else []), *section(STREAMS, in_order(status))],
        [*_kept(status.get("kept", {}), width), *section(KEPT, status.get("kept", {}).get("for", ()))],
        section(FEATURES, failing(status.get("features", ()))),
        wrapped(ALONE, width) if status.get("peers") == [] else section(PEERS, sorted(peers, key=_standing)),
        _otherwise(status, width),
    ]
    lacking = f"; left out for want of room: {', '.join(left_out)}" if left_out else ""
    parts.append(wrapped(f"sendworthy status --explain says what each word means{lacking}", width))
    return "\n\n".join("\n".join(part) for part in parts if part)


def _otherwise(status: Status, width: int | None) -> list[str]:
    """Name robots with other specs than ours, as far as they have said; each with the generation of its own."""
    others = [peer for peer in status.get("peers", ()) if peer.get("specs") not in {None, "", status.get("specs")}]
    named = ", ".join(sorted(f"{peer.get('robot', UNKNOWN)} ({peer['specs']})" for peer in others))
    return wrapped(clean(OTHERWISE.format(named)), width) if named else []


def headline(status: Status, width: int | None = None) -> list[str]:
    """Say what the daemon is, in one line or as many as that takes."""
    facts = (
        f"robot {clean(str(status.get('robot', UNKNOWN)))}",
        f"mode {status.get('mode', UNKNOWN)}",
        *([f"sendworthy {status['version']}"] if status.get("version") else []),
        f"up {duration(status.get('uptime'))}",
        unspecified(status) or f"specs {status.get('specs', UNKNOWN)}",
        f"coordination {status.get('coordination', UNKNOWN)}",
        f"transport {status.get('transport', UNKNOWN)}",
    )
    lines = [facts[0]]
    for fact in facts[1:]:
        longer = f"{lines[-1]}{BETWEEN}{fact}"
        if width is not None and len(longer) > width:
            lines.append(fact)
        else:
            lines[-1] = longer
    return [line for each in lines for line in wrapped(each, width)]


def wrapped(line: str, width: int | None, indent: str = "") -> list[str]:
    """Break a line between words where it is too long."""
    if width is None or len(line) <= width:
        return [line]
    return textwrap.wrap(line, width, subsequent_indent=indent, break_on_hyphens=False)


def in_order(status: Status) -> list[Status]:
    """Return the streams, our own first, and those that are over last."""
    own = status.get("robot")
    return sorted(
        status.get("streams", ()),
        key=lambda each: (
            each.get("robot") != own,
            bool(each.get("over")),
            str(each.get("robot")),
            str(each.get("key")),
        ),
    )


def _standing(peer: Status) -> tuple[bool, str]:
    """Those first that take no part."""
    return bool(peer.get("takes_part", True)), str(peer.get("robot"))


def unspecified(status: Status) -> str:
    """Say where there are no specs, and what that means; nothing where there are any."""
    if status.get("specs") != Specs.empty().generation:
        return ""
    return f"no specs in {status.get('daemon', {}).get('specs', UNKNOWN)}: everything passes"


def _counts(counts: Status, width: int | None) -> list[str]:
    reasons, sizes = counts.get("by_reason", {}), counts.get("bytes", {})
    law = " + ".join(f"{counts.get(name, 0)} {name}" for name in ("forwarded", "dropped", "queued"))
    rows = [
        ("", word, str(n), amount(sizes[word], "B") if word in sizes else "", reason(word))
        for word, n in sorted(reasons.items(), key=lambda pair: -pair[1])
    ]
    shown = 4 if any(row[3] for row in rows) else 3
    begins = columns([row[:shown] for row in rows], "llrr"[:shown]) if rows else []
    told = [row[-1] for row in rows]
    return [*wrapped(f"samples  {counts.get('in', 0)} in = {law}", width, BETWEEN), *_explained(begins, told, width)]


def _explained(begins: Sequence[str], told: Sequence[str], width: int | None) -> Iterator[str]:
    """Yield lines with what is told of each behind it, in as many lines as that takes."""
    indent = max(map(len, begins), default=0) + len("  ")
    for begin, each in zip(begins, told, strict=True):
        first, *others = wrapped(each, None if width is None else max(LEAST_TOLD, width - indent)) or [""]
        yield f"{begin:{indent}}{first}".rstrip()
        yield from (" " * indent + other for other in others)


def _decisions(decisions: Status, width: int | None) -> list[str]:
    """What the searches came to, and why the last one decided so; nothing when there was none."""
    made = decisions.get("made", 0)
    without = [("", said.format(decisions[name])) for name, said in WITHOUT_SEARCH.items() if decisions.get(name)]
    if not (made or without or decisions.get("late")):
        return []
    each = f", {decisions.get('iterations', 0) / made:.0f} iterations each" if made else ""
    rows = [("decided", f"{made} {'time' if made == 1 else 'times'}{each}"), *without]
    if made and decisions.get("seconds"):
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
    return _labelled([*rows, *_last(decisions.get("last") or {})], width)


def _labelled(rows: Sequence[tuple[str, str]], width: int | None) -> list[str]:
    """Return texts behind their labels."""
    indent = max(len(label) for label, _ in rows) + 2
    return [
        (label if first else "").ljust(indent) + line
        for label, said in rows
        for first, line in zip(
            (True, *[False] * len(said)),
            wrapped(clean(said), None if width is None else max(20, width - indent)),
            strict=False,
        )
    ]


def _loss(decisions: Status) -> str:
    lost = decisions.get("gap", 0.0) / max(decisions.get("utility", 0.0), 1e-9)
    return f"at most {lost:.2%} of the utility lost"


def _last(last: Status) -> list[tuple[str, str]]:
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


def _adaptive(budget: Sequence[Status], width: int | None) -> list[str]:
    """How adaptive limits came to be what they are."""
    return [
        line
        for limit in budget
        if (adaptive := limit.get("adaptive"))
        for line in wrapped(
            f"{limit.get('constraint', UNKNOWN)} is adaptive: {share(adaptive.get('in_force'), 1.0)} of its ceiling, "
            f"{share(adaptive.get('estimate'), 1.0)} by our estimate ({adaptive.get('reason', UNKNOWN)}, "
            f"delay {duration(adaptive.get('delay'))})",
            width,
            "  ",
        )
    ]


def _kept(kept: Mapping[str, Status], width: int | None) -> list[str]:
    """The copies for robots that were away, and what became of them; nothing when there were none."""
    if not kept.get("in"):
        return []
    reasons = {"waiting": kept.get("waiting", 0)} | dict(kept.get("by_reason", {}))
    law = " + ".join(f"{count} {reason}" for reason, count in reasons.items())
    return wrapped(f"kept  {kept['in']} copies for robots that were away = {law}", width, "  ")
