"""Missions flown by policies."""

import pytest

from studies.bench.errors import BenchError
from studies.bench.flying import BUILT_IN, Score, check, fly
from studies.bench.folder import MISSIONS
from studies.bench.format import read
from studies.bench.worth import bounded
from tests.studies.bench.small import lines, write


@pytest.fixture(scope="module")
def mission(tmp_path_factory):
    """The small mission with its true bound: of two samples a second one fits."""
    pytest.importorskip("scipy")
    return bounded(read(write(tmp_path_factory.mktemp("bench") / "small.jsonl")))


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_policy_flies(mission, name):
    """Within the bound; those that know limits keep them where messages come one after the other."""
    score = fly(mission, name)
    assert (score.mission, score.policy) == ("small", name)
    assert 0.0 < score.utility <= 1.0
    assert score.over == (pytest.approx(0.5, abs=0.06) if name == "all" else 0.0)
    assert score.decision[0] <= score.decision[1]


def test_who_sends_everything_pays_for_what_was_refused(mission):
    """The channel carries what fits; the score is less by the part that did not."""
    score = fly(mission, "all")
    assert score.sent == 1.0
    assert score.score == pytest.approx(score.utility * (1.0 - score.over))


def test_daemons_are_better_than_who_sends_what_fits(mission):
    """The sample that comes later in each second is worth three times as much, and who is told of it leaves room."""
    assert fly(mission, "best").score > 1.5 * fly(mission, "greedy").score


@pytest.mark.full
def test_daemons_do_not_exceed_a_limit_where_what_does_is_refused():
    """What is refused is lost, and a robot that took its own samples to arrive less surely would plan otherwise."""
    score = fly(read(MISSIONS / "paper-most.jsonl"), "best")
    assert score.over <= 0.02
    assert score.score > 0.9


def test_a_flight_is_the_same_again(mission, tmp_path):
    """With what is lost, too."""
    lossy = read(write(tmp_path / "small.jsonl", lines(loss=0.3)))
    one, other = fly(lossy, "best"), fly(lossy, "best")
    assert (one.utility, one.sent, one.told) == (other.utility, other.sent, other.told)
    assert one.utility < fly(mission, "best").utility * mission.head.bound / lossy.head.bound


def test_daemons_tell_each_other_something_and_others_nothing(mission):
    """The table has it."""
    assert fly(mission, "best").told > 0.0
    assert fly(mission, "planner").told == 0.0


def test_a_limit_of_messages_is_kept_by_daemons_whatever_they_tell(tmp_path):
    """Where samples are of one size the specs leave room for digests beside them, else they say the limit itself."""
    limits = [{"kind": "messages", "limit": 1.0, "window": 0.9}]
    equal = fly(read(write(tmp_path / "equal.jsonl", lines(limits=limits))), "best")
    assert (equal.over, equal.sent) == (0.0, pytest.approx(0.45, abs=0.06))
    given = lines(limits=limits)
    given[-1] = [*given[-1][:2], 12_000]
    unequal = fly(read(write(tmp_path / "unequal.jsonl", given)), "best")
    assert unequal.over == 0.0


def test_utility_below_nothing_is_no_better_for_what_was_refused():
    """The score is the utility then."""
    assert Score("m", "p", -0.5, 1.0, 0.5, 0.0, (0.0, 0.0)).score == -0.5
    assert Score("m", "p", 0.5, 1.0, 0.5, 0.0, (0.0, 0.0)).score == 0.25


def test_an_unknown_policy_is_told():
    """Before anything flies."""
    check("greedy")
    with pytest.raises(BenchError, match="policy greddy: "):
        check("greddy")
