"""Which messages of the streams that compete are to be expected, and how far ahead a window looks."""

from bisect import bisect_right
from collections.abc import Sequence

from proxy.core.coordination.claims import claim
from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.model.limits import Limit, Limits, changes_plans, longest_window, use_of
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.view.stream import Stream
from proxy.core.view.tuning import TUNING as VIEW
from proxy.core.view.view import SharedView
from proxy.core.window.candidates import Candidate, guaranteed
from proxy.core.window.tuning import TUNING


def forecast(
    now: float, view: SharedView, candidates: list[Candidate], limits: Limits, deciding: Stream | None
) -> None:
    """Fill in the expected generation times of every candidate, as far ahead as plans look.

    Others' messages since we last heard of them are decisions, too, but for those with a lesser claim than `deciding`.
    """
    longest, until = longest_window(limits.union), now + view.settings.horizon_time
    end, ours = min(until, now + MODEL.planned_windows * longest), None
    for c in candidates:
        decided = c.own
        if not decided and deciding is not None and not limits.agreed:
            ours = ours or claim(now, deciding)
            decided = claim(now, c.stream) < ours
        after = now if decided else _unheard_since(now, view, c, limits, longest)
        times = c.stream.schedule.forecast(after, end, TUNING.forecasts_of_a_stream, now)
        c.expect(times or c.stream.schedule.forecast(after, until, 1, now))
    if not limits.alone:
        _choose(candidates, limits.union)


def reach(now: float, candidates: list[Candidate], limits: Limits, most: int) -> float:
    """Return until when a window looks ahead that holds about so many messages [s]: over a window of limits at least.

    Looking as far as ever, every second left out, one robot reached 0.2 % less with 80 messages, 2.3 with 40.
    """
    times = sorted([t for c in candidates for t in c.times])
    if len(times) > most:
        times = times[: max(most, bisect_right(times, now + longest_window(limits.union)))]
    return max([times[-1] if times else now, *[c.times[0] for c in candidates if c.times]])


def _unheard_since(now: float, view: SharedView, c: Candidate, limits: Limits, longest: float) -> float:
    """Return when the first message of another robot's stream was or will be generated whose fate is open [s]."""
    stream, schedule = c.stream, c.stream.schedule
    heard = schedule.last or now
    if stream.sent is not None:
        heard = max(heard, stream.sent.t_gen + 0.5 * schedule.period)
    if heard >= now:
        return heard
    use = use_of(stream.newest.size, c.copies, limits.union, own=False)
    if not (view.subscribers.overhears(stream.robot) or changes_plans(use, limits.union)):
        return max(heard, now - longest)
    within = (TUNING.agreed_within if limits.agreed else TUNING.overheard_within) + view.staleness.delay
    return max(heard, now - _latency(view, c) - within - schedule.jitter)


def _latency(view: SharedView, c: Candidate) -> float:
    """What samples of another robot take to us [s]: others may hear of them sooner."""
    sender = view.members.called(c.stream.robot)
    line = None if sender is None else sender.inbound.line
    if sender is None or line is None:
        return c.audience.latency
    return max(line.of(c.stream.newest.size), sender.offset.latency)


def _choose(candidates: list[Candidate], limits: tuple[Limit, ...]) -> None:
    """Where far more is offered than can be sent expect only the smallest samples of bulky streams to be sent.

    Not within a part that is ours alone, which seldom has another one to choose from: thirty robots reached 92 % of a
    central decider instead of 96 (unicast).
    """
    uses = [use_of(round(c.stream.sizes.mean), c.copies, limits, own=c.own) for c in candidates]
    rates = [1.0 / max(c.stream.schedule.period, VIEW.least_period) for c in candidates]
    offers = [[rate * u for u in use] for rate, use in zip(rates, uses, strict=True)]
    if _sent_part(offers, limits) >= 1.0:
        return
    worths = [c.worth for c in candidates]
    for c, use, worth in zip(candidates, uses, worths, strict=True):
        stream = c.stream
        bulky = any(u > TUNING.bulky * limit.limit for u, limit in zip(use, limits, strict=True))
        varied = stream.sizes.deviation > TUNING.varied * stream.sizes.mean and stream.schedule.kind != MEMORYLESS
        if not bulky or not varied or guaranteed(stream):
            continue
        least = TUNING.rival_worth * worth
        part = _sent_part([offer for offer, other in zip(offers, worths, strict=True) if other >= least], limits)
        if part < 1.0:
            chosen = [t for i, t in enumerate(c.times) if int((i + 1) * part) > int(i * part)]
            c.expect(chosen or c.times[-1:], stream.sizes.smallest(part))


def _sent_part(offers: Sequence[Sequence[float]], limits: tuple[Limit, ...]) -> float:
    """Return what part of the samples is expected to be sent of streams that offer so much [limits' units/s]."""
    offered = [sum([offer[k] for offer in offers]) for k in range(len(limits))]
    carried = [
        TUNING.offered * limit.limit / limit.window / rate
        for limit, rate in zip(limits, offered, strict=True)
        if rate > 0.0
    ]
    return max(TUNING.sent_at_least, min(carried, default=1.0))
