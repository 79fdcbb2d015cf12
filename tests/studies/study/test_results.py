"""Means, shares and differences."""

import pytest

from studies.study.contenders import BOUND
from studies.study.programme import bound_of
from studies.study.results import Mean, Results
from studies.study.store import Store
from studies.study.tasks import Task
from tests.studies.study.records import record

TASK = Task("best", "mixed", 5.0, 0)


def test_a_mean_has_a_confidence_interval():
    """Student's, for few values; of one value there is none."""
    found = Mean.of([1.0, 2.0, 3.0])
    assert (found.mean, found.count) == (2.0, 3)
    assert found.half == pytest.approx(2.4841, abs=1e-4)
    assert Mean.of([1.0]).half is None
    assert Mean.of([0.5]).percent() == "50.0"
    assert Mean.of([0.5, 0.5]).percent() == "50.0 ± 0.0"


@pytest.mark.parametrize(
    ("values", "above", "below"), [([1.0, 1.1], True, False), ([-1.0, -1.1], False, True), ([-1.0, 1.1], False, False)]
)
def test_signs_count_beyond_the_interval(values, above, below):
    """What lies within it proves nothing, and one value nothing at all."""
    found = Mean.of(values)
    assert (found.above_nothing, found.below_nothing) == (above, below)
    assert not Mean.of(values[:1]).above_nothing


def test_shares_are_those_of_the_same_mission(tmp_path):
    """Whatever network, loss or iterations; what was not flown has none."""
    with Store(tmp_path / "records.jsonl") as store:
        lossy = TASK.but(loss=0.1, network="own", iterations=7)
        store.add(lossy, record(utility=30.0, sent=10))
        store.add(bound_of(lossy), record(utility=60.0))
        store.add(TASK.but(contender="paper", seed=9), record())
    results = Results(store)
    assert bound_of(lossy) == bound_of(TASK) == Task(BOUND, "mixed", 5.0, 0)
    assert results.share(lossy) == 0.5
    assert results.of_maximum(lossy) == 0.3
    assert results.sent(lossy) == results.received(lossy) == 0.1
    assert results.share(TASK) is None
    assert results.mean([TASK, lossy], results.share).count == 1
    assert results.mean([TASK], results.share) is None
    assert results.ahead([(TASK, lossy)]) is None
    assert results.ahead([(lossy, lossy)]).mean == 0.0
