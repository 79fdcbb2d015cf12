"""Decisions on a stream as text for people. Their JSON form is made in `proxy.core.why`."""

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from proxy.live_streams import MEANT, REASONS
from proxy.quantities import UNKNOWN, Status, amount, columns, duration, number

AT_ONCE = 1e-3
"""What takes no longer happens at once [s]."""
LABEL = 11
"""Characters of the column that says what a line is about."""

CAUSES: Mapping[tuple[str, str], str] = {
    ("forwarded", "unneeded"): "there was room for all",
    ("forwarded", "owed"): "a guarantee of its type demanded it",
    ("forwarded", "certain"): "it is small, and each robot keeps a little room for that whatever others say",
    ("forwarded", "undisputed"): "it earns what room costs",
    ("forwarded", "search"): "it is worth more than others for what was left",
    ("dropped:planner", "hopeless"): "it does not earn what room costs",
    ("dropped:constraint", "unkept"): "a guarantee of its type demanded it, but a limit had no room for it",
    ("passed:fallback", "late"): "the search had no answer in time, and it fitted",
    ("dropped:fallback", "late"): "the search had no answer in time, and there was no room",
    ("passed:fallback", "rule"): "the planner failed, and there was room",
    ("waits", ""): "there is no room for the copy yet",
    ("waits", "search"): "its room may just be taken, so it waits for its turn",
}
"""Why a sample met its fate, where the cause says more than the reason alone."""
FATES: Mapping[str, str] = {
    **REASONS,
    "passed:unwanted": "nobody on another robot wants it",
    "passed:mode": "the mode is pass",
    "waits": "it waits",
}
BESIDE: Mapping[str, str] = {
    "": "has no room for it beside what was sent",
    "booked": "has no room for it beside what is kept for streams that are always sent",
    "rivals": "has no room for it, for a robot whose sample is worth more may just be sending",
}
"""What takes the room that is lacking."""


def headed(stream: Status, width: int) -> Iterator[str]:
    """Yield what stream it is and how it fares, and what of it is undecided."""
    of = f"type {stream.get('type')}" if stream.get("type") else "no type of the specs in force plans for it now"
    mode = str(stream.get("mode", UNKNOWN))
    wanted = stream.get("receivers", 0)
    made, sent = stream.get("generated", 0), stream.get("forwarded", 0)
    yield f"{stream.get('key', UNKNOWN)} of robot {stream.get('robot', UNKNOWN)}"
    facts = f"{of}; mode {mode}{MEANT.get(mode, '')}; wanted by {wanted} robot{'s' * (wanted != 1)}"
    yield from _wrapped("  ", f"{facts}; {made} made, {sent} sent, {made - sent} not", width)
    for each in stream.get("undecided", ()):
        yield from _wrapped("  ", _undecided(each), width)


def _undecided(each: Status) -> str:
    what = f"a sample of {amount(each.get('size'), 'B')} that is {duration(each.get('age'))} old"
    if each.get("deciding"):
        return f"{what} is being decided"
    opens_in = each.get("opens_in")
    return f"{what} waits" + (f" for room, for {duration(opens_in)} at least" if opens_in is not None else "")


def described(decision: Status, when: str, width: int) -> Iterator[str]:
    """Yield what was decided `when`, and why, line by line; the stream is known from the lines before."""
    yield from _wrapped("", f"{when}: {_fate(decision)}", width, "  ")
    rows = [("sample", _sample(decision)), ("no room", _lacking(decision)), ("at present", _market(decision))]
    search = decision.get("search")
    if search:
        rows += [
            ("best plans", _plans(search)),
            ("price", _price(search)),
            ("scarce", _scarce(search)),
            ("certainty", _certainty(search)),
        ]
    for label, text in rows:
        if text:
            yield from _wrapped(f"  {label.ljust(LABEL)} ", text, width)
    if search:
        yield from _competitors(search, str(search.get("own", {}).get("robot")), width)


def again(decision: Status, more: int, when: str, width: int) -> Iterator[str]:
    """Yield that the same was decided on more samples."""
    yield from _wrapped("", f"{when}: {more} more: {_fate({**decision, 'count': 1})}", width, "  ")


def _fate(decision: Status) -> str:
    reason, cause, count = str(decision.get("reason")), str(decision.get("cause")), decision.get("count", 1)
    why = CAUSES.get((reason, cause)) or FATES.get(reason, "")
    did = "waits" if reason.startswith("waits") else "sent" if decision.get("sent") else "dropped"
    if decision.get("shadowed"):
        did = "would be dropped in enforce, sent in shadow"
    many = f"{count} samples " if count > 1 else ""
    copy = f"copy for {decision['copy_to']}, which was away, " if decision.get("copy_to") else ""
    return f"{copy}{many}{did.upper() if not decision.get('shadowed') else did}: {why} ({reason})"


def _sample(decision: Status) -> str:
    size, worth, held = decision.get("size"), decision.get("worth"), decision.get("decided_at_age")
    if size is None:
        return ""
    value = f", worth {number(worth)} in its first second" if worth is not None else ""
    if ends := (decision.get("search") or {}).get("ends"):
        value += f", and it ends a loss of {number(ends)} a second: what was sent last shows too much"
    when = "" if held is None else f"; decided {_after(held)}"
    which = "the last one has " if decision.get("count", 1) > 1 else ""
    return f"{which}{amount(size, 'B')}{value}{when}"


def _after(seconds: float) -> str:
    return "at once" if seconds < AT_ONCE else f"{duration(seconds)} after it was made"


def _lacking(decision: Status) -> str:
    lacking = decision.get("lacking", ())
    return f"{', '.join(lacking)} {BESIDE.get(str(decision.get('beside')), '')}" if lacking else ""


def _market(decision: Status) -> str:
    """What room costs, and what its stream earns by how often it sends."""
    market = decision.get("market") or {}
    if not market.get("price"):
        return ""
    price, least, most = (number(market.get(name)) for name in ("price", "least", "most"))
    cost, interval = f"the room of one costs {price}", duration(market.get("interval"))
    if market.get("standing") == "priced" and market.get("every"):
        return f"{cost}; at that it pays to send one every {duration(market['every'])}, of one every {interval}"
    if market.get("standing") == "hopeless":
        return f"{cost}, and even the first in a long time would earn only {most}"
    return f"{cost}, and each earns at least {least} though all are sent, one every {interval}"


def _plans(search: Status) -> str:
    """The best plans with and without the sample, and their difference."""
    with_it, without, difference, lead = (search.get(name) for name in ("with", "without", "difference", "lead"))
    if with_it is None or without is None or difference is None:
        found = "without" if with_it is None else "with"
        known = number(without if with_it is None else with_it)
        return f"the team gains {known} {found} it; no plan was found that {'sends' if with_it is None else 'drops'} it"
    text = f"the team gains {number(with_it)} with it and {number(without)} without it: {_more(difference)} with it"
    if lead is not None and abs(lead - difference) > 1e-9 * max(abs(lead), abs(difference)):
        text += f"; counting what follows the planned time, {_more(lead)}"
    return text


def _more(difference: float) -> str:
    return f"{number(abs(difference))} {'more' if difference > 0.0 else 'less'}" if difference else "the same"


def _price(search: Status) -> str:
    """What its room costs and what it would earn."""
    earns, price, sends = search.get("earns"), search.get("price", 0.0), search.get("send")
    asked = [f"{name} {number(each)}" for name, each in search.get("prices", {}).items() if each]
    cost = f"its room costs {number(price)}" + f" ({', '.join(asked)})" * (len(asked) > 1) if asked else "room is free"
    if earns is None:
        return cost
    changes = "adds {} to" if earns >= 0.0 else "takes {} from"
    if not sends:
        changes = "would add {} to" if earns >= 0.0 else "would take {} from"
    return f"{cost}; it {changes.format(number(abs(earns)))} the best plan that sends it"


def _scarce(search: Status) -> str:
    return ", ".join(search.get("binding", ())) or "no limit"


def _certainty(search: Status) -> str:
    """How sure the planner was, and what that took."""
    gap, iterations, allowed = search.get("gap"), search.get("iterations", 0), search.get("allowed", 0)
    if search.get("proven"):
        sure = "proven, no plan is better"
    elif gap is None:
        sure = "the best plan found; by how much others may be better is not known"
    else:
        best = max(search.get("with") or 0.0, search.get("without") or 0.0)
        part = f" ({gap / best:.1%})" if best > 0.0 else ""
        sure = f"no plan is better by more than {number(gap)}{part}"
    ended = ", cut short by the deadline" if search.get("cut") else ""
    took = f" in {duration(search['seconds'])}" if search.get("seconds") is not None else ""
    held, full = search.get("messages", 0), search.get("messages_of", 0)
    thinned = f"; {held} of {full} messages were looked at, to be done in time" if held < full else ""
    return f"{sure}; {iterations} of {allowed} iterations{took}{ended}{thinned}"


def _competitors(search: Status, robot: str, width: int) -> Iterator[str]:
    """What it competed with, by name and worth: samples that wait, and those that are expected soon."""
    own, rivals, more = search.get("own", {}), search.get("competitors", ()), search.get("more", 0)
    listed = [each for each in (own, *rivals) if each.get("messages")]
    if not listed:
        yield from _wrapped(f"  {'beside'.ljust(LABEL)} ", "nothing else competes with it", width)
        return
    yield f"  {'beside'.ljust(LABEL)} what else waits or is expected, its worth, and how many are sent"
    rows = [_competitor(each, robot, this=each is own) for each in listed]
    head = ("STREAM", "WORTH", "SIZE", "PER kB", "SENT")
    names = max(12, width - LABEL - 40)
    short = [(_shortened(row[0], names), *row[1:]) for row in (head, *rows)]
    yield from (f"  {' ' * LABEL} {line}" for line in columns(short, "lrrrr"))
    if more:
        yield f"  {' ' * LABEL} and {more} more stream{'s' * (more > 1)}"


def _competitor(each: Mapping[str, Any], robot: str, *, this: bool) -> Sequence[str]:
    worth, size = each.get("worth"), each.get("size")
    per_kilobyte = worth * 1000.0 / size if worth is not None and size else None
    of = "its own next ones" if this else str(each.get("key", UNKNOWN))
    name = of if this or each.get("robot") == robot else f"{of} of {each.get('robot')}"
    sent = f"{each.get('sent', 0)} of {each.get('messages', 0)}"
    return (name, number(worth), amount(size, "B"), number(per_kilobyte), sent)


def _shortened(name: str, most: int) -> str:
    """Leave out the middle of what is too long: the ends of keys tell them apart."""
    if len(name) <= most:
        return name
    head = (most - 1) // 3
    return f"{name[:head]}…{name[head + 1 - most :]}"


def _wrapped(label: str, text: str, width: int, indent: str | None = None) -> Iterator[str]:
    """Yield a text behind its label, in lines of so many characters."""
    further = " " * len(label) if indent is None else indent
    yield from textwrap.wrap(
        text,
        max(width, len(label) + 20),
        initial_indent=label,
        subsequent_indent=further,
        break_long_words=False,
        break_on_hyphens=False,
    )
