"""Which pattern a stream has."""

import math

import pytest

from proxy.core.forecast.recognition import History, Recognition, _spread
from proxy.core.forecast.rhythm import Rhythm, fit
from proxy.core.forecast.tuning import TUNING
from tests.proxy.core.streams import bursts, periodic, poisson
from utility_specs.schedules import PoissonRule
from utility_specs.specs import Failures

SECOND = Rhythm(1.0, 24.0, 20, 0.0, 16)


def seen(times, pause=0.5):
    """A history of these times, in which longer gaps are pauses."""
    history, last = History(), times[0]
    for number, t in enumerate(times, 1):
        history.note_gap(paused=t - last > pause)
        history.note((number, t), paused=t - last > pause)
        last = t
    return history


@pytest.mark.parametrize(
    ("times", "kind"),
    [(periodic(20), "periodic"), (poisson(60, seed=1), "poisson"), (bursts(8), "bursts 5 0.05")],
)
def test_what_is_seen_shows_the_kind(times, kind):
    """Where nobody says anything else."""
    history = seen(times, 9.0 if kind != "bursts 5 0.05" else 0.5)
    assert Recognition().pattern(history, fit(list(history.past))).kind == kind


def test_a_rule_goes_before_a_report_and_a_report_before_what_is_seen():
    """Each can be taken back, or be another one."""
    recognition, history = Recognition(), seen(periodic(20), 9.0)
    assert recognition.report("poisson", 3.0)
    assert not recognition.report("poisson", 3.0)
    assert recognition.pattern(history, SECOND).period == 3.0
    assert recognition.set_rule(PoissonRule(4.0), Failures())
    assert not recognition.set_rule(PoissonRule(4.0), Failures())
    assert recognition.pattern(history, SECOND).period == 4.0
    recognition.set_rule(None, Failures())
    recognition.report("periodic", 1.0)
    assert recognition.pattern(history, SECOND).kind == "periodic"


def test_without_a_rhythm_only_reports_tell():
    """One sample has none."""
    recognition, history = Recognition(), seen([1.0])
    assert recognition.pattern(history, None) is None
    recognition.report("bursts 5 0.05", 0.2)
    assert recognition.pattern(history, None).kind == "bursts 5 0.05"


def test_random_gaps_deviate_and_those_of_a_rhythm_do_not():
    """Whatever is missing of either."""
    random, regular = list(enumerate(poisson(400, seed=2))), list(enumerate(periodic(400, jitter=0.1, seed=2)))
    for step in (1, 3, 10):
        assert _spread(random[::step]) == pytest.approx(0.7, abs=0.25)
        assert _spread(regular[::step]) < 0.15


def past_of(*times, paused=()):
    """A history of these times; before some of them is a pause."""
    history = History()
    for number, t in enumerate(times, 1):
        history.note_gap(paused=t in paused)
        history.note((number, t), paused=t in paused)
    return history


def test_without_samples_everything_is_newer():
    """Any number and any time."""
    assert History().newest == (0, -math.inf)


def test_the_longest_gap_is_none_of_the_pauses_and_fades():
    """Each sample lets it shrink a little."""
    history = past_of(0.0, 3.0, 4.0, 99.0, paused=(99.0,))
    assert history.longest_gap == 3.0 * TUNING.gap_fade
    assert history.pauses == 1
    assert history.resumed
    assert past_of(0.0, 50.0, 99.0, 100.0, paused=(50.0, 99.0)).pauses == 0


def test_a_pause_long_ago_is_none_of_the_recent_past():
    """So many samples came since."""
    history = past_of(*range(100), paused=(3,))
    assert not history.resumed
    assert len(history.past) == TUNING.memory
    assert history.first == (1, 0)


def test_some_or_all_of_the_past_can_be_forgotten():
    """The first sample is, only when all begins anew."""
    history = past_of(0.0, 1.0, 2.0, 3.0)
    history.forget_since(3.0)
    assert history.newest == (3, 2.0)
    history.keep(2)
    assert list(history.past) == [(2, 1.0), (3, 2.0)]
    history.keep(0)
    assert not history.past
    assert history.first == (1, 0.0)
    history.restart()
    assert (history.first, history.longest_gap) == (None, 0.0)
