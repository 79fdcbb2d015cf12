"""How often costly features are computed."""

import sys
from dataclasses import dataclass, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs import load_specs
from utility_specs.features import Feature
from utility_specs.features import pace as module
from utility_specs.features.pace import Pace, Paces

BUDGET = 0.01


def computed(costs, samples):
    """Let samples come, each computation at once and with the next of the costs, the last for ever; return which."""
    pace, when, costs = Pace(0.0), [], list(costs)
    for number in range(samples):
        if pace.quick(BUDGET) or pace.due(BUDGET):
            when.append(number)
            pace.took(costs.pop(0) if len(costs) > 1 else costs[0], float(number))
    return when, pace


def test_what_keeps_to_its_budget_is_computed_for_every_sample():
    """Up to the budget itself."""
    assert computed([BUDGET], 5)[0] == [0, 1, 2, 3, 4]


def test_what_takes_four_budgets_is_computed_for_every_fourth_sample():
    """The value of the last computation stays in between."""
    when, pace = computed([4 * BUDGET], 12)
    assert when == [0, 4, 8]
    assert (pace.value, pace.cost) == (8.0, 4 * BUDGET)


def test_one_outlier_is_forgotten():
    """As the smoothed cost comes down, every sample is computed again."""
    when, pace = computed([2 * BUDGET, 0.1 * BUDGET], 20)
    assert when[-10:] == list(range(10, 20))
    assert pace.quick(BUDGET)


@given(st.floats(1e-4, 0.5))
def test_on_average_nothing_takes_more_than_its_budget(cost):
    """A steady cost, once it is known."""
    when, _ = computed([cost], 100)
    assert (len(when) - 1) * cost <= 100 * BUDGET * 1.0001 or cost <= BUDGET


def test_one_computation_at_a_time():
    """None begins while one is under way; one that was refused may begin with the next sample."""
    pace = Pace(0.5)
    pace.took(BUDGET, 1.0)
    assert pace.due(BUDGET)
    assert not pace.due(BUDGET)
    pace.refused()
    assert pace.due(BUDGET)
    pace.took(BUDGET, 2.0)
    assert pace.value == 2.0


def test_streams_and_features_have_their_own_paces():
    """What was not computed yet has its default."""
    paces = Paces()
    paces.of("red", "a", 0.1).took(3.0, 1.0)
    paces.of("red", "b", 0.1).took(5.0, 2.0)
    paces.of("blue", "a", 0.3)
    assert paces.of("red", "c", 0.1).cost == 4.0  # b began with what a takes
    assert [paces.of(name, key, 0.1).value for name, key in (("red", "a"), ("red", "b"), ("blue", "a"))] == [1, 2, 0.3]
    assert paces.costs() == {"red": 4.0}


def test_what_holds_is_counted():
    """By feature."""
    paces = Paces()
    for name in ("red", "blue", "red"):
        paces.hold(name)
    assert paces.held() == {"red": 2, "blue": 1}


def test_streams_are_bounded(monkeypatch):
    """Those that were silent longest are forgotten, and counted."""
    monkeypatch.setattr(module, "STREAMS", 2)
    paces = Paces()
    for number, key in enumerate(("a", "b", "a", "c")):
        paces.of("red", key, 0.0).took(1.0, float(number))
    assert paces.evicted == 1
    assert paces.of("red", "a", 0.0).value == 2.0
    assert paces.of("red", "b", 0.0).value == pytest.approx(0.0)


class Bench:
    """A background that does jobs when the test says so, and a clock that only features move.

    What is waited for is done at once, if it is `prompt`, and else when the test says so, too.
    """

    def __init__(self, room=1, *, prompt=True):
        self.time, self.room, self.prompt, self.jobs = 0.0, room, prompt, []

    def now(self):
        return self.time

    def later(self, job):
        if len(self.jobs) >= self.room:
            return False
        self.jobs.append(job)
        return True

    def within(self, _patience, job):
        if self.prompt:
            job()
            return True
        return self.later(job)


@dataclass(frozen=True)
class Slow(Feature):
    """Takes a while to find the number that is the payload."""

    bench: Bench
    takes: float

    def measure(self, sample):
        self.bench.time += self.takes
        return float(sample.payload)


@pytest.fixture
def paced(tmp_path):
    """An information type with features that take so long [s]."""
    path = tmp_path / "x.toml"
    path.write_text('[[information_type]]\nname = "t"\nkeys = ["t/**"]\nutility = { kind = "video" }\n')
    (loaded,) = load_specs(path).types

    def make(bench, **features):
        slow = [(name, Slow(bench, takes, budget=BUDGET, default=-1.0)) for name, takes in features.items()]
        return replace(loaded, features=tuple(slow))

    return make


def test_a_costly_feature_of_a_sample_has_the_value_of_an_earlier_one(paced):
    """It is computed in the background for every third sample; the others are computed at once, for each."""
    bench = Bench()
    each = paced(bench, slow=3 * BUDGET, quick=BUDGET / 2)
    found = []
    for number in range(9):
        found.append(each.extract("t", str(number).encode(), None, bench))
        while bench.jobs:
            bench.jobs.pop()()
    assert [values["quick"] for values in found] == list(range(9))
    assert [values["slow"] for values in found] == [0, 0, 0, 0, 3, 3, 3, 6, 6]
    assert each.paces.held() == {"slow": 8}
    assert each.failures.counts() == {}


def test_streams_do_not_wait_for_each_other(paced):
    """Each has its own values and its own pace; where there is no room in the background, the next sample tries."""
    bench = Bench(room=1)
    each = paced(bench, slow=BUDGET * 1.5)
    assert each.extract("a", b"1", None, bench) == {"slow": 1.0}
    assert each.extract("b", b"2", None, bench) == {"slow": -1.0}  # as in the other stream, it would take too long
    bench.jobs.pop()()
    for _ in range(4):
        assert each.extract("a", b"5", None, bench) == {"slow": 1.0}
        assert each.extract("b", b"6", None, bench) == {"slow": 2.0}
    bench.jobs.pop()()
    assert each.extract("a", b"7", None, bench) == {"slow": 5.0}
    assert each.extract("b", b"8", None, bench) == {"slow": 2.0}
    bench.jobs.pop()()
    assert each.extract("b", b"9", None, bench) == {"slow": 8.0}


def test_a_costly_feature_that_fails_has_its_default_until_the_next_one(paced):
    """And is counted once."""
    bench = Bench()
    each = paced(bench, slow=2 * BUDGET)
    each.extract("t", b"1", None, bench)
    for _ in range(2):
        each.extract("t", b"broken", None, bench)
    bench.jobs.pop()()
    assert each.extract("t", b"2", None, bench) == {"slow": -1.0}
    assert each.failures.counts() == {"slow": 1}


def test_the_first_one_is_waited_for_no_longer_than_its_budget(paced):
    """Nobody knows what it takes: if that is more, defaults hold until it is there."""
    bench = Bench(room=2, prompt=False)
    each = paced(bench, slow=3 * BUDGET, quick=BUDGET / 2)
    assert each.extract("t", b"1", None, bench) == {"slow": -1.0, "quick": -1.0}
    assert each.extract("t", b"2", None, bench) == {"slow": -1.0, "quick": -1.0}
    assert len(bench.jobs) == 2
    for job in bench.jobs:
        job()
    bench.jobs.clear()
    assert each.extract("t", b"3", None, bench) == {"slow": 1.0, "quick": 3.0}
    assert each.paces.held() == {"slow": 3, "quick": 2}


class Endless(Slow):
    """It may never come to an end."""

    ends = False


class Leaving(Slow):
    """Ends the thread that computes it, if it can."""

    def measure(self, _sample):
        sys.exit()


def only(each, feature):
    return replace(each, features=(("x", feature),))


def test_what_may_never_end_is_waited_for_no_longer_than_its_budget(paced):
    """However quick it was before; a sample comes while it hangs, and none hangs behind it."""
    bench = Bench()
    each = only(paced(bench), Endless(bench, BUDGET / 2, budget=BUDGET))
    assert each.extract("t", b"1", None, bench) == {"x": 1.0}
    assert each.extract("t", b"2", None, bench) == {"x": 2.0}
    bench.prompt = False
    assert each.extract("t", b"3", None, bench) == {"x": 2.0}
    assert each.extract("t", b"4", None, bench) == {"x": 2.0}
    (job,) = bench.jobs
    job()
    bench.prompt = True
    assert each.extract("t", b"5", None, bench) == {"x": 5.0}
    assert each.paces.held() == {"x": 2}


def test_while_a_feature_hangs_no_more_samples_wait_for_it_than_may(paced):
    """However many streams there are, each held up to be computed later; those that were refused try again."""
    bench = Bench(room=2, prompt=False)
    each = only(paced(bench), Endless(bench, BUDGET / 2, budget=BUDGET, default=-1.0))
    for _ in range(2):
        for number in range(module.STREAMS + 50):
            assert each.extract(f"t{number}", b"1", None, bench) == {"x": -1.0}
    assert len(bench.jobs) == 2
    bench.prompt = True
    assert each.extract(f"t{module.STREAMS}", b"2", None, bench) == {"x": 2.0}


def test_a_feature_that_calls_exit_has_failed(paced):
    """The thread goes on."""
    bench = Bench()
    each = only(paced(bench), Leaving(bench, BUDGET / 2, default=-1.0))
    assert each.extract("t", b"1", None, bench) == {"x": -1.0}
    assert each.failures.counts() == {"x": 1}


def test_whoever_has_little_time_knows_whether_features_are_quick(paced):
    """Those of whose cost nothing is known are not, nor those that take longer or may never come to an end."""
    bench = Bench()
    each = paced(bench, slow=BUDGET / 2)
    assert not each.extracts_within("t", BUDGET)
    each.extract("t", b"1", None, bench)
    assert each.extracts_within("t", BUDGET)
    assert not each.extracts_within("t", BUDGET / 4)
    endless = only(each, Endless(bench, BUDGET / 2, budget=BUDGET))
    endless.extract("t", b"1", None, bench)
    assert not endless.extracts_within("t", BUDGET)
