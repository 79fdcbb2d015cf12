"""Parts of specs by their places, and cores that have them."""

from collections import deque
from dataclasses import replace
from functools import partial
from itertools import count

import pytest

from planner import SearchSettings, start
from planner.utility import Step
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward, SendCopy
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import State
from proxy.recording.errors import RecordingError
from proxy.recording.spec_parts import COUNTS, PAST, Past, SpecParts
from tests.proxy.recording.flights import Doubled
from utility_specs import load_specs
from utility_specs.specs import Failures

SPECS = """
[[constraint]]
kind = "throughput"
limit = "40 kbit/s"
window = 0.5
[[information_type]]
name = "written"
keys = ["robot/${robot:*}/written/${n:*}"]
utility = { kind = "python", function = "tests.utility_specs.worths:by_number" }
scale = "10 - n"
features.size = { kind = "size" }
[information_type.forecast]
features = { size = { python = "tests.utility_specs.outlooks:doubled" } }
schedule = { kind = "python", function = "tests.utility_specs.outlooks:every_two" }
[[information_type]]
name = "shown"
keys = ["robot/*/shown"]
aggregation = { python = "tests.utility_specs.models:Greatest" }
utility = { kind = "table", points = [["0 s", 1.0], ["1 s", 0.5], ["2 s", 0.0]] }
features.size = { kind = "size" }
forecast = { features = "auto", schedule = { kind = "times", times = [0, 1], every = 3 } }
[[information_type]]
name = "map"
keys = ["robot/*/map"]
aggregation = "once"
utility = { kind = "step", lifetime = "30 s" }
forecast = { schedule = { kind = "poisson", rate = "1 Hz" } }
"""


@pytest.fixture
def load(tmp_path):
    """Load specs, which are new ones each time."""

    def made(text=SPECS):
        (tmp_path / "specs.toml").write_text(text)
        return load_specs(tmp_path)

    return made


def test_parts_are_where_they_were(load):
    """Also in specs that were loaded elsewhere."""
    here, there = load(), load()
    written, shown, _ = here.types
    places, parts = SpecParts(here), SpecParts(there)
    for one, other in (
        (here, there),
        (written, there.types[0]),
        (written.failures, there.types[0].failures),
        (written.schedule, there.types[0].schedule),
        (written.forecast.of("size")[0], there.types[0].forecast.of("size")[0]),
        (shown.utility, there.types[1].utility),
        (shown.aggregation, there.types[1].aggregation),
    ):
        assert parts.at(places.place(one)) is other


def test_what_is_made_of_a_part_is_made_again_once(load):
    """A type that knows the chunks of a key, a utility that knows features."""
    here, there = load(), load()
    places, parts = SpecParts(here), SpecParts(there)
    covering = here.match("robot/r1/written/3")
    place = places.place(covering)
    assert parts.at(place).captured == covering.captured
    assert parts.at(place).captured["n"] == 3.0
    assert parts.at(place) is parts.at(place)
    utility = parts.at(places.place(covering.utility_of({"size": 2.0})))
    assert utility.features == {"size": 2.0, "n": 3.0}
    assert utility.function is there.types[0].utility.function


def test_what_is_past_has_nothing(load):
    """Nor is anything counted that nobody looks at."""
    places = SpecParts(load())
    older = load(SPECS.replace("10 - n", "9 - n"))
    assert places.place(older.types[0]) == (PAST,)
    assert places.place(older.types[1].utility) == (PAST,)
    assert places.place(Step(1.0, 2.0)) == (PAST,)
    assert isinstance(places.at((PAST,)), Past)
    assert places.place(Failures()) == (COUNTS,)
    assert places.at((COUNTS,)).counts() == {}


@pytest.mark.parametrize("place", [(), (99,), (-1,), ("x",), (0, {}), (3, {}), (1.5,), (1, [])])
def test_no_other_places_are_there(load, place):
    """Whatever they look like."""
    with pytest.raises(RecordingError, match=r"a part of specs that there is not|by_number raises KeyError"):
        SpecParts(load()).at(place)


@pytest.mark.full
def test_a_core_under_such_specs_does_the_same_elsewhere(load):
    """Also while it waits for an answer, with what functions of the operator's say, and copies for who is away."""
    specs = load()
    core = Doubled(Core(CoreSettings("r1", "z1", away=60.0), specs, 0.0), 23, load=load)
    state = State("r2", "z2", "enforce", specs.generation, (), ("robot/**",), number=1)
    comes = [ev.PeerAppeared(0.5, "r2", "z2"), ev.StateHeard(0.5, state)]
    numbers, answers = count(), deque(comes)
    for step in range(90):
        now = 1.0 + 0.1 * step
        answers += {60: [ev.PeerGone(now, "r2", "z2")], 75: [replace(each, now=now) for each in comes]}.get(step, [])
        for key in ("written/3", "written/4", "shown", "map"):
            features = {} if key == "map" else {"size": 1000.0 + step % 7}
            answers.append(
                ev.SamplePublished(now, next(numbers), f"robot/r1/{key}", 1500, now, None, 5, features),
            )
        while answers:
            answers += map(partial(answered, now), core.handle(answers.popleft()))
        core.handle(ev.TimePassed(now + 0.05))
    assert core.snapshots > 20
    assert core.searching
    assert core.kept.copies


def answered(now, command):
    """Return what a core hears of a command."""
    match command:
        case Decide():
            search = start(command.problem, SearchSettings(), command.seed)
            search.run(50)
            return ev.DecisionReady(now, command.ticket, search.plan())
        case Forward(sample):
            return ev.SampleHanded(now, sample)
        case SendCopy(sample, to):
            return ev.CopyHanded(now, sample, to)
    return ev.TimePassed(now)
