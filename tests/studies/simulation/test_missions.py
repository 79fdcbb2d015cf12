"""Missions as a team flies them."""

import pytest

from planner import Linear
from proxy.core.model.limits import limits_of
from studies.simulation.conditions import Conditions
from studies.simulation.missions import SIZE, SLACK, draw, scenario
from studies.workload import FEW_IMPORTANT, MIXED, SCENARIOS


@pytest.mark.parametrize("transport", ["unicast", "broadcast"])
@pytest.mark.parametrize("limit", [2, 10])
def test_messages_have_the_limit_for_themselves(transport, limit):
    """What robots tell each other comes on top; or it is inside, and messages have less."""
    how = Conditions(transport=transport, limit=limit, seconds=5.0)
    flown = draw(MIXED, 1, how)
    (left,) = limits_of(flown.specs, how.allowance, how.members)
    assert left.limit == pytest.approx(flown.carried) == (limit + SLACK) * SIZE
    inside = draw(MIXED, 1, Conditions(transport=transport, limit=limit, seconds=5.0, digests_inside=True))
    (left,) = limits_of(inside.specs, how.allowance, how.members)
    assert left.limit < inside.carried == inside.gross


def test_specs_say_what_the_mission_holds():
    """Of every robot the weight of its messages, and about the slope of each."""
    flown = draw(FEW_IMPORTANT, 3, Conditions(seconds=5.0))
    for message, frame in zip(flown.problem.messages, flown.frames, strict=True):
        spec = flown.specs.match(frame.key)
        assert spec.weight == message.scale
        assert isinstance(spec.utility, Linear)
        assert spec.utility.slope == pytest.approx(message.utility.slope, abs=0.01)
        assert frame.t_gen == message.t_gen


@pytest.mark.parametrize("transport", ["unicast", "broadcast"])
def test_mixed_sizes_have_specs_of_all_kinds(transport):
    """Streams of four robots, and a limit in bytes."""
    flown = draw(MIXED, 0, Conditions(transport=transport, limit=10, seconds=20.0), "mixed")
    assert len({type(each.utility) for each in flown.specs.types}) == 5
    assert [frame.size for frame in flown.frames] == [message.use[0] for message in flown.problem.messages]
    assert {frame.robot for frame in flown.frames} <= set(flown.interests)
    generated = sum(frame.size for frame in flown.frames)
    assert flown.carried == pytest.approx(0.4 * generated * 2.5 / 30.0)


def test_scenarios_have_names():
    """Their first letters are enough."""
    assert [scenario(name) for name in ("few", "mixed", "most")] == list(SCENARIOS)
    with pytest.raises(ValueError, match="few important"):
        scenario("none")
