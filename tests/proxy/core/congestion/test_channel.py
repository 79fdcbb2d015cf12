"""The limits in force: those of the specs, and what the channel bears of adaptive ones."""

import math

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import SetPace
from proxy.core.model.limits import limits_of
from tests.proxy.core.talk import SPEC

ADAPTIVE = SPEC.replace('limit = "{limit}"', 'limit = "adaptive"\nceiling = "{limit}"').format(
    limit="800 kbit/s", window=1.0
)


def test_fixed_limits_are_in_force_as_they_are(make_talk, make_specs):
    """Nothing is told to the driver, and all of the allowance may be used."""
    talk = make_talk(make_specs(limit="80 kbit/s"))
    talk.want(0.0)
    channel = talk.core.channel
    assert not channel.look(1.0, 0)
    assert channel.apply() is None
    assert channel.allowance_factor == 1.0
    assert talk.core.budget.limits == limits_of(talk.core.view.specs, 0.0, 2)


def test_an_adaptive_limit_begins_with_a_part_of_its_ceiling(make_talk, make_specs):
    """In budget and pace alike; the allowance shrinks less than in proportion."""
    talk = make_talk(make_specs(text=ADAPTIVE))
    talk.want(0.0)
    (factor,) = talk.core.channel.capacity.factors
    (limit,) = talk.core.budget.limits
    assert 0.0 < factor < 1.0
    (ceiling,) = limits_of(talk.core.view.specs, 0.0, 2)
    assert limit.limit == pytest.approx(factor * ceiling.limit)
    assert talk.core.channel.allowance_factor == pytest.approx(math.sqrt(factor))
    assert talk.all(SetPace)[-1].rate == pytest.approx(factor * 100_000.0)


def test_a_limit_that_is_fixed_again_ends_the_pace(make_talk, make_specs):
    """The driver is told that there is none any more."""
    talk = make_talk(make_specs(text=ADAPTIVE))
    talk.want(0.0)
    talk.tell(ev.SpecsChanged(1.0, make_specs(limit="80 kbit/s")))
    assert talk.all(SetPace)[-1].rate == math.inf


def test_what_is_not_looked_at_any_more_is_not_late_for_ever(make_talk, make_specs):
    """Where limits stop being adaptive, nobody finds that a queue has drained."""
    talk = make_talk(make_specs(text=ADAPTIVE))
    talk.want(0.0)
    talk.core.channel.staleness = 0.5
    talk.tell(ev.SpecsChanged(1.0, make_specs(limit="80 kbit/s")))
    assert talk.core.channel.staleness == 0.0
