"""What a robot uses beyond its part, as seldom all use theirs at once."""

import random

import pytest

from proxy.core.coordination.overbooking import Overbooking
from proxy.core.coordination.tuning import TUNING
from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.split.table import Table, TableLog
from tests.proxy.core.coordination.conftest import WINDOW

PACE = 0.25


def looked(overbooking, used, robots=50, seconds=30.0, now=0.0):
    """Robots use of their part what `used` says, at each look; return when the last one was."""
    for step in range(round(seconds / PACE)):
        now += PACE
        overbooking.advance(now, used(step), robots)
    return now


def test_at_first_a_part_is_a_part():
    """What seldom happens is not known yet."""
    overbooking = Overbooking(TUNING.use_deviations)
    looked(overbooking, lambda _: 0.1, seconds=0.9 * TUNING.use_known * TUNING.use_memory)
    assert overbooking.factor == 1.0


@pytest.mark.parametrize(
    ("used", "factor"), [(1.0, 1.0), (0.8, 1.25), (0.1, TUNING.overbooked), (0.0, TUNING.overbooked)]
)
def test_who_uses_little_of_what_it_may_may_use_more(used, factor):
    """So much more that it uses its part in the mean, and never more than a few times that."""
    overbooking = Overbooking(TUNING.use_deviations)
    looked(overbooking, lambda _: used)
    assert overbooking.factor == pytest.approx(factor)


def test_room_is_left_for_what_use_varies_by():
    """Less the more robots there are: their deviations add up to less."""
    found = []
    for robots in (25, 100):
        overbooking = Overbooking(TUNING.use_deviations)
        looked(overbooking, lambda step: (0.3, 0.9)[step % 2], robots)
        found.append(1.0 / overbooking.factor)
    assert found == pytest.approx(
        [0.6 + TUNING.use_deviations * 0.3 / 5.0, 0.6 + TUNING.use_deviations * 0.3 / 10.0], abs=0.02
    )


def test_all_together_use_what_they_have():
    """Robots as unlike as they may be, whose messages are a small or a large part of what they may use."""
    rng, robots, together = random.Random(1), 40, []
    team = [(Overbooking(TUNING.use_deviations), rng.uniform(0.3, 1.0)) for _ in range(robots)]
    for step in range(400):
        use = 0.0
        for overbooking, filled in team:
            used = rng.choice([filled, filled, 0.5 * filled])
            use += used * overbooking.factor / robots
            overbooking.advance(step * PACE, used, robots)
        together.append(use)
    settled = together[len(together) // 2 :]
    assert 0.8 < sum(settled) / len(settled) < 1.0
    assert sum(use > 1.0 for use in settled) <= 0.05 * len(settled)


def test_a_team_that_is_large_again_begins_anew():
    """What was used long ago says nothing of now."""
    overbooking = Overbooking(TUNING.use_deviations)
    now = looked(overbooking, lambda _: 0.2)
    overbooking.advance(now + 2.0 * TUNING.use_memory, 1.0, 50)
    assert overbooking.factor == 1.0


def agreed(*segments):
    """What robots that ask for these agreed on."""
    entries = {f"r{number}": (1, (segment,)) for number, segment in enumerate(segments)}
    return TableLog(0.0, Table("r0", entries, members=len(entries), floor=100, kind=b""))


def beyond(log):
    overbooking = Overbooking(TUNING.agreed_deviations)
    for step in range(200):
        overbooking.look(step * PACE, log, lambda _, used=(0.5, 0.7)[step % 2]: used, WINDOW)
    return overbooking.factor


def test_who_uses_little_of_an_agreed_part_may_use_more():
    """Less where one robot has most of the limit, as then nobody evens out what it varies by."""
    alike = beyond(agreed(*[Segment(800, 100)] * 12))
    unlike = beyond(agreed(Segment(8_000, 100), *[Segment(100, 100)] * 11))
    assert 1.0 == unlike < 1.2 < alike < TUNING.overbooked


def test_nobody_uses_more_than_its_part_beside_slots_that_robots_share():
    """Each uses these in turn; nor before anything is agreed on."""
    sharing = agreed(*[Segment(UNIT // 2, 100, 2)] * 4)
    assert sharing.agreed.turns
    assert beyond(sharing) == beyond(None) == 1.0
