"""Adaptive limits where there is no channel that they could follow."""

import pytest

from studies.replay.adaptive import Borne, as_borne
from studies.replay.errors import ReplayError
from studies.simulation.missions import specs_of
from tests.studies.replay.traffic import spec

FIXED = spec()
ADAPTIVE = FIXED.replace('limit = "8 kbit/s"', 'limit = "adaptive"\nceiling = "80 kbit/s"')
AIRTIME = ADAPTIVE + (
    '[[constraint]]\nkind = "airtime"\nname = "air"\nlimit = "adaptive"\nceiling = "50 %"\nrate = "6 Mbit/s"\n'
    '[[constraint]]\nkind = "messages"\nlimit = 10\n'
)


def borne(*told):
    """What digests told, by robot, time and the parts of the ceilings."""
    found = Borne()
    for robot, now, parts in told:
        found.note(robot, now, {"command": "SendDigest", "digest": {"capacity": parts}})
    return found


def test_limits_are_fixed_at_what_the_channel_bore_in_the_mean():
    """Over time, not over digests; of all robots. What is fixed already stays as it is."""
    found = borne(
        *[("r1", 0.0, [1.0, 0.5]), ("r1", 3.0, [0.2, 0.5]), ("r1", 4.0, [0.4, 0.5])],
        *[("r2", 0.0, [0.6, 0.5]), ("r2", 4.0, [0.6, 0.5])],
    )
    specs, notes = as_borne(specs_of(AIRTIME), found)
    mean = (3 * 1.0 + 1 * 0.2 + 4 * 0.6) / 8
    assert [each.least for each in specs.constraints] == [1.0, 1.0, 1.0]
    assert specs.constraints[0].measure.rate == pytest.approx(mean * 10_000)
    assert specs.constraints[1].measure.fraction == pytest.approx(0.25)
    assert specs.constraints[2] == specs_of(AIRTIME).constraints[2]
    assert notes[0] == (
        "the limit throughput was adaptive, and is fixed here at the 70 % of its ceiling that the channel bore in the"
        " mean (20 to 100 %)"
    )


@pytest.mark.parametrize(("ceiling", "rate", "percent"), [("800 kbit/s", 5_000, 5), ("20 kbit/s", 2_500, 100)])
def test_what_the_channel_bore_is_the_same_under_other_specs(ceiling, rate, percent):
    """Half of the ceiling that was recorded is another part of another one, and no more than all of it."""
    other = specs_of(ADAPTIVE.replace("80 kbit/s", ceiling))
    specs, notes = as_borne(other, borne(("r1", 0.0, [0.5])), specs_of(ADAPTIVE))
    assert specs.constraints[0].measure.rate == pytest.approx(rate)
    assert f"fixed here at the {percent} % of its ceiling" in notes[0]


def test_what_the_channel_bore_of_another_limit_is_not_known():
    """Airtime tells nothing of throughput, nor do specs that had no limit."""
    airtime = ADAPTIVE.replace('"throughput"', '"airtime"').replace('"80 kbit/s"', '"50 %"\nrate = "6 Mbit/s"')
    for recorded, reason in ((airtime, "of one of airtime: --limit"), (FIXED, "nothing .*--limit")):
        with pytest.raises(ReplayError, match=reason):
            as_borne(specs_of(ADAPTIVE), borne(("r1", 0.0, [0.5])), specs_of(recorded))


def test_a_digest_does_not_hold_for_ever():
    """While a robot said nothing for long it may have been away."""
    assert borne(("r1", 0.0, [0.2]), ("r1", 1000.0, [0.8]), ("r1", 1010.0, [1.0])).parts[0].mean == pytest.approx(0.5)
    assert borne(("r1", 0.0, [0.2])).parts[0].mean == 0.2


def test_what_is_fixed_stays_whatever_was_recorded():
    """Without a word."""
    specs = specs_of(FIXED)
    assert as_borne(specs, borne(("r1", 0.0, [0.5]))) == (specs, [])


@pytest.mark.parametrize("told", [[], [("r1", 0.0, [0.5, 0.5])], [("r1", 0.0, ["a"])], [("r1", 0.0, [0.0])]])
def test_what_is_not_known_is_not_guessed(told):
    """It says which limit, and what can be done."""
    with pytest.raises(ReplayError, match=r"the limit throughput is adaptive, and nothing .*--limit"):
        as_borne(specs_of(ADAPTIVE), borne(*told))


def test_what_is_no_digest_says_nothing():
    """Other commands, digests without limits, and whatever a stranger's file has in their place."""
    found = Borne()
    for command in ({"command": "Forward", "sample": 1}, {"digest": 5}, {"digest": {}}, {"digest": {"capacity": 1}}):
        found.note("r1", 0.0, command)
    assert not found.parts
