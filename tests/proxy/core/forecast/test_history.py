"""The past of a stream."""

import math

from proxy.core.forecast.recognition import History
from proxy.core.forecast.tuning import TUNING


def seen(*times, paused=()):
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
    history = seen(0.0, 3.0, 4.0, 99.0, paused=(99.0,))
    assert history.longest_gap == 3.0 * TUNING.gap_fade
    assert history.pauses == 1
    assert history.resumed
    assert seen(0.0, 50.0, 99.0, 100.0, paused=(50.0, 99.0)).pauses == 0


def test_a_pause_long_ago_is_none_of_the_recent_past():
    """So many samples came since."""
    history = seen(*range(100), paused=(3,))
    assert not history.resumed
    assert len(history.past) == TUNING.memory
    assert history.first == (1, 0)


def test_some_or_all_of_the_past_can_be_forgotten():
    """The first sample is, only when all begins anew."""
    history = seen(0.0, 1.0, 2.0, 3.0)
    history.forget_since(3.0)
    assert history.newest == (3, 2.0)
    history.keep(2)
    assert list(history.past) == [(2, 1.0), (3, 2.0)]
    history.keep(0)
    assert not history.past
    assert history.first == (1, 0.0)
    history.restart()
    assert (history.first, history.longest_gap) == (None, 0.0)


def test_numbering_may_begin_or_end():
    """That is noticed once."""
    history = History()
    assert not history.set_numbered(numbered=True)
    assert history.set_numbered(numbered=False)
    assert not history.set_numbered(numbered=False)
