"""An explanation of a sample's worth as text for people. Its JSON form is made in `utility_specs.explaining`."""

import math
from collections.abc import Iterator, Sequence

from planner.problem import Aggregation
from proxy.quantities import UNKNOWN, amount, columns, duration, number
from utility_specs.competing import Competitor
from utility_specs.explaining import (
    AGGREGATIONS,
    Explanation,
    FeatureValue,
    Use,
    Worked,
    Worth,
    combined,
    figure,
    kind_of,
)
from utility_specs.lifetimes import Lifetime, sampled
from utility_specs.suggestions import quoted
from utility_specs.terminal_plot import WIDTH, Style, plot

QUARTERED = (1.0, 1.2, 1.6, 2.0, 2.4, 2.8, 3.2, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 30.0, 40.0, 60.0)
"""Multiples of a unit at whose ends, and quarters, plots have labels."""
LARGE = 1.0 + 1e-9
"""Of more than this part of a limit a sample fits into no window."""


def described(explanation: Explanation, style: Style) -> Iterator[str]:
    """Yield what matched, what makes the worth, the utility over age, and what the sample takes, line by line."""
    worth = explanation.worth
    copies = f", for {explanation.receivers} robots" if explanation.receivers != 1 else ""
    what = f"{explanation.key} ({amount(float(explanation.size), 'B')}{copies})"
    if worth is None:
        yield f"{what}: no information type covers this key"
        yield "  so its samples pass at once, undecided; they lower what the limits leave to all others"
        for near in explanation.near:
            yield f"  near is {near.expression}, but {', '.join(near.differences)}"
    else:
        yield f"{what}: information type {quoted(worth.type.name)}"
        yield from _matched(worth)
        yield from ["", *_factors(worth), "", *_over_age(worth, style), "", *_rules(worth)]
    yield from ["", *_uses(explanation)]


def ranking(competitors: Sequence[Competitor], what: str) -> Iterator[str]:
    """Yield a table of competitors; `what` heads the column of their names."""
    rows = [
        (
            ">" if each.this else "",
            each.name,
            _figure(each.value),
            amount(each.size, "B"),
            _figure(each.per_kilobyte),
            each.note,
        )
        for each in competitors
    ]
    head = ("", what, "FIRST SECOND", "SIZE", "PER kB", "")
    yield from columns([head, *rows], "llrrrl")


def _matched(worth: Worth) -> Iterator[str]:
    yield f"  covered by {worth.covering.expression} ({worth.covering.place})"
    if worth.captured:
        yield f"  which captures {', '.join(f'{name} = {text}' for name, text in worth.captured.items())}"
    for each in worth.later:
        yield f"  {quoted(each.type)} comes later, so its {each.expression} does not count here ({each.place})"


def _factors(worth: Worth) -> Iterator[str]:
    """How the worth comes about: weight, scale with the numbers put in, and the utility of a fresh sample."""
    fresh = figure(worth.lifetime.fresh)
    factors = (figure(worth.weight.value), figure(worth.scale.value), fresh)
    yield f"worth {figure(worth.factor * worth.lifetime.fresh)} per second {_when(worth.lifetime)}"
    yield f"  = weight × scale × utility = {' × '.join(factors)}"
    rows = [
        *((f"  feature {each.name}", f"= {figure(each.value)}{_remark(each)}") for each in worth.features),
        ("  weight", f"= {_worked(worth.weight)}"),
        ("  scale", f"= {_worked(worth.scale)}"),
        ("  utility", f"= {fresh}, {kind_of(worth.utility)}: {_fading(worth.lifetime)}"),
    ]
    yield from columns(rows, "ll")
    if worth.failed_utility:
        yield "  the function of the utility fails for these features, so the defaults of all features hold for it"


def _remark(each: FeatureValue) -> str:
    if each.why is not None:
        return f", its default: {each.why}"
    return "" if each.used else ", which nothing uses"


def _worked(each: Worked) -> str:
    """`1 + 10 * red = 1 + 10 * 0.35 = 4.5`, and a plain number as it is."""
    if each.why is not None:
        return f"{each.text} = {each.filled}: {each.why}, so it counts as {figure(each.value)}"
    steps = dict.fromkeys((each.text, each.filled, figure(each.value)))
    return " = ".join(steps) if each.text.removesuffix(".0") != figure(each.value) else figure(each.value)


def _when(lifetime: Lifetime) -> str:
    return f"at {duration(lifetime.young)}, infinite at 0" if lifetime.young else "when fresh"


def _fading(lifetime: Lifetime) -> str:
    """Say how a utility goes by in words."""
    parts = []
    if lifetime.half_life is not None and lifetime.half_life != lifetime.end:
        parts.append(f"half of that after {duration(lifetime.half_life)}")
    if lifetime.end is None:
        parts.append("never nothing")
    else:
        parts.append(f"{'less than 1 %' if lifetime.rest else 'nothing'} from {duration(lifetime.end)} on")
    return ", ".join(parts)


def _over_age(worth: Worth, style: Style) -> Iterator[str]:
    """Plot the worth over age, and say it at the ages that matter."""
    lifetime, factor = worth.lifetime, worth.factor
    if factor <= 0.0:
        yield "worth nothing at any age: weight × scale is 0"
        return
    until = _round_age(lifetime.shown)
    values = factor * sampled(worth.utility, lifetime.young, until, WIDTH * style.across)
    labels = [_age(part * until) for part in (0.0, 0.25, 0.5, 0.75, 1.0)]
    yield "worth per second, by age"
    yield from plot(values.tolist(), labels, _figure, style=style)
    ages = [(lifetime.young, lifetime.fresh)]
    if lifetime.half_life is not None and lifetime.half_life != lifetime.end:
        ages.append((lifetime.half_life, lifetime.fresh / 2.0))
    if lifetime.end is not None:
        ages.append((lifetime.end, lifetime.rest))
    yield from columns(
        [("age", *(_age(age) for age, _ in ages)), ("worth", *(_figure(factor * value) for _, value in ages))],
        "l" + "r" * len(ages),
    )
    total = "without end after it" if lifetime.total is None else f"{_figure(factor * lifetime.total)} in all"
    yield f"to each robot that has it at once {_figure(worth.value)} in its first second, {total}"


def _round_age(age: float) -> float:
    """Return an age not far above that has quarters which can be read."""
    unit = 60.0 if age > 60.0 else 10.0 ** math.floor(math.log10(age))
    return next((unit * n for n in QUARTERED if unit * n >= age), age)


def _age(age: float) -> str:
    return duration(age) if age else "0"


def _figure(value: float | None) -> str:
    """Write a number with three digits, or all that are before the point."""
    return number(value) if value is None or value < 1000.0 else f"{value:.0f}"


def _rules(worth: Worth) -> Iterator[str]:
    """What the type says besides worth."""
    of = worth.type
    words = AGGREGATIONS.get(of.aggregation) if isinstance(of.aggregation, Aggregation) else None
    yield f"aggregation {combined(of.aggregation)}" + f": {words}" * bool(words)
    if of.mode is not None:
        yield f"mode {of.mode}, whatever the daemon's is unless that is pass"
    if of.bypass:
        yield "bypass: goes at once, whatever it is worth and whatever the limits leave"
    if of.guarantee.min_rate is not None:
        yield f"min_rate: {of.guarantee.min_rate:g} samples of its stream per second, whatever they are worth"
    if of.guarantee.max_age is not None:
        yield f"max_age: no receiver's last sample shall get older than {duration(of.guarantee.max_age)}"


def _uses(explanation: Explanation) -> Iterator[str]:
    """What it takes of each limit, and how many like it there can be."""
    if not explanation.uses:
        yield "no limits: the specs have no constraint, so everything can be sent"
        return
    head = ("LIMIT", "", "IT TAKES", "OF", "WHICH IS", "SUCH SAMPLES FILL IT AT")
    yield from columns([head, *map(_use, explanation.uses)], "llrrrr")


def _use(each: Use) -> Sequence[str]:
    adaptive = "of its ceiling" if each.adaptive else "each robot's own" if each.private else ""
    rate = UNKNOWN if each.rate is None else f"{_figure(each.rate)} per second"
    if each.rate is not None and each.part > LARGE:
        rate = f"one in {duration(1.0 / each.rate)}"
    window = f"{amount(each.limit, each.unit)} in any {duration(each.window)}"
    return (each.name, adaptive, amount(each.used, each.unit), window, f"{each.part * 100:.3g} %", rate)
