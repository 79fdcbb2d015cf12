"""What a daemon's status says of one stream and of those it competes with, for `sendworthy explain`."""

from collections.abc import Iterator, Mapping
from typing import Any

from planner.utility import integral
from proxy.quantities import UNKNOWN, Status, columns, duration, number, schedule
from utility_specs.competing import Competitor, ranked, rules
from utility_specs.specs import Specs
from utility_specs.suggestions import quoted

MEANT = {"shadow": ": it decides, but sends all", "pass": ": it sends all, and decides nothing"}
"""What the daemon's mode means for what is decided."""

REASONS: Mapping[str, str] = {
    "dropped:planner": "others are worth more for what is left",
    "dropped:constraint": "a limit has no room for it",
    "dropped:once": "its type says 'once', and all who want it have one of this key",
    "dropped:fallback": "the planner failed, and there is little room",
    "dropped:superseded": "a newer one came before its turn",
    "dropped:overflow": "too many waited",
    "dropped:full": "too many waited for the mesh",
    "dropped:too-large": "it is larger than a message may be",
    "dropped:egress": "the mesh session did not take it",
    "passed:fallback": "the planner failed",
}
"""What was decided on samples, in words."""


def streams_of(status: Status, key: str) -> list[Status]:
    """Return what the status says of the streams of a key, those of the daemon's own robot first."""
    found = [each for each in status.get("streams", ()) if each.get("key") == key]
    return sorted(found, key=lambda each: each.get("robot") != status.get("robot"))


def known(status: Status, key: str) -> Iterator[str]:
    """Yield what the daemon knows of the streams of a key, line by line."""
    robot = status.get("robot", UNKNOWN)
    mode = status.get("mode", UNKNOWN)
    yield f"what robot {robot} knows (mode {mode}{MEANT.get(mode, '')})"
    streams = streams_of(status, key)
    if not streams:
        yield "  nothing of this key: no type of the specs in force covers it, nobody on another robot wants it, or"
        yield "  bridge.out denies it or lets it pass"
    rows = [row for each in streams for row in _stream(each, several=len(streams) > 1)]
    yield from columns([*rows, *_decision(status, key), *_counts(status)], "ll")


def competing(status: Status, specs: Specs, key: str) -> tuple[Competitor, ...]:
    """Return all streams that the daemon knows, the worthiest by byte first."""
    types = {each.name: each for each in specs.types}
    found = []
    for each in status.get("streams", ()):
        of = types.get(str(each.get("type")))
        value = None if of is None else each.get("scale", 0.0) * integral(of.utility, 1.0)
        note = f"type {quoted(str(each.get('type')))} is not in these specs" if of is None else rules(of)
        facts = ["nobody wants it"] * (not each.get("receivers", 0)) + ["it is over"] * bool(each.get("over"))
        note = ", ".join(filter(None, [note, *facts]))
        this = each.get("key") == key and each.get("robot") == status.get("robot")
        name = f"{each.get('key')} of {each.get('robot')}"
        found.append(Competitor(name, value, each.get("size"), this=this, note=note))
    return ranked(found)


def live_data(status: Status, key: str) -> dict[str, Any]:
    """Return what the daemon knows of the streams of a key as plain JSON data."""
    last = status.get("decisions", {}).get("last") or {}
    return {
        "robot": status.get("robot"),
        "mode": status.get("mode"),
        "specs": status.get("specs"),
        "streams": streams_of(status, key),
        "last_decision": last if last.get("key") == key else None,
        "by_reason": status.get("counts", {}).get("by_reason", {}),
    }


def _stream(each: Status, *, several: bool) -> Iterator[tuple[str, str]]:
    """What is known of one stream."""
    made, sent = each.get("generated", 0), each.get("forwarded", 0)
    period = each.get("period")
    mean = " on average" if str(each.get("schedule")).startswith(("bursts", "poisson")) else ""
    every = f", every {duration(period)}{mean}" if period and not each.get("over") else ""
    if several:
        yield (f"  of {each.get('robot', UNKNOWN)}", "")
    yield ("  generates", f"{schedule(each)}{every}, the last {_ago(each.get('last_generated'))}")
    forecast = ", ".join(f"{name} by {method}" for name, method in (each.get("forecast") or {}).items())
    yield ("  next ones", f"expected {forecast or 'to be like the last one'}")
    yield (
        "  samples",
        f"{made} made, {sent} sent, {made - sent} not; the last sent {_ago(each.get('last_forwarded'))}",
    )
    for place, (reason, count) in enumerate(each.get("by_reason", {}).items()):
        yield ("" if place else "  decided on", f"{count} {_reason(reason)}")
    wanted = each.get("receivers", 0)
    yield ("  wanted by", f"{wanted} robot{'s' * (wanted != 1)}")


def _reason(reason: str) -> str:
    """What became of a sample, in words where it has some."""
    return f"{reason} ({REASONS[reason]})" if reason in REASONS else reason


def _ago(seconds: float | None) -> str:
    return "never" if seconds is None else f"{duration(max(0.0, seconds))} ago"


def _decision(status: Status, key: str) -> Iterator[tuple[str, str]]:
    """Why the last decision was what it was, where it was one on this key."""
    last = status.get("decisions", {}).get("last") or {}
    if last.get("key") != key:
        return
    yield ("  last one", f"{_reason(str(last.get('reason')))}, {_ago(last.get('age'))}")
    did, otherwise = ("sent", "dropped") if last.get("send") else ("dropped", "sent")
    plans = f"{number(last.get('utility'))} with it {did}, {_compared(last)} with it {otherwise}"
    yield ("", f"the team's best plan is worth {plans}")
    if lead := _despite(last):
        yield ("", f"with what follows the window that is {number(lead)} less")
    prices = {name: price for name, price in last.get("prices", {}).items() if price}
    if prices or last.get("binding"):
        scarce = dict.fromkeys([*prices, *last.get("binding", ())])
        yield ("", f"scarce: {', '.join(scarce)}")


def _compared(last: Status) -> str:
    """How much less or more the opposite of a decision is worth; nobody sees that in two numbers of three digits."""
    utility, opposite = last.get("utility"), last.get("opposite")
    if utility is None or opposite is None:
        return UNKNOWN
    more = opposite - utility
    return f"{number(abs(more))} {'more' if more > 0.0 else 'less'}" if more else "the same"


def _despite(last: Status) -> float:
    """By how much a decision is better although its opposite is worth more in the window; 0.0 where it is not."""
    utility, opposite, lead = last.get("utility"), last.get("opposite"), last.get("lead")
    if utility is None or opposite is None or lead is None:
        return 0.0
    return max(0.0, lead) if opposite > utility else 0.0


def _counts(status: Status) -> Iterator[tuple[str, str]]:
    reasons = status.get("counts", {}).get("by_reason", {})
    if reasons:
        said = (f"{count} {reason}" for reason, count in sorted(reasons.items(), key=lambda pair: -pair[1]))
        yield ("  all keys", ", ".join(said))
