"""Cores whose samples combine in several ways, and cores that keep copies for robots that are away."""

import pytest

from proxy.core.core import Core
from proxy.core.model.settings import CoreSettings
from tests.proxy.core.samples.absent import ALARMS, OTHER, Away
from tests.proxy.core.talk import SPEC


@pytest.fixture
def make_aggregated(make_talk, make_specs):
    """A core whose camera samples combine as told, with robot op that wants them."""

    def make(aggregation, limit="80 kbit/s", **settings):
        text = SPEC.format(limit=limit, window=1.0).replace('"most_recent"', f'"{aggregation}"')
        talk = make_talk(make_specs(text=text), **settings)
        talk.want(0.0)
        return talk

    return make


@pytest.fixture
def make(make_specs):
    """A core of robot r1 with the robots `away` and `here`, that keeps what is missed for up to 100 s."""

    def make(aggregation="sum", limit="", **rest):
        specs = make_specs(text=limit + ALARMS.format(aggregation=aggregation))
        rest = {"coordination": "announce", "allowance": 0.0, "away": 100.0} | rest
        talk = Away(Core(CoreSettings("r1", "z-r1", **rest), specs, 0.0))
        talk.specs = specs
        talk.arrive(0.0)
        talk.arrive(0.0, "here", OTHER)
        return talk

    return make
