"""Which pattern a stream has."""

import pytest

from proxy.core.forecast.recognition import History, Recognition
from proxy.core.forecast.rhythm import Rhythm, fit
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
