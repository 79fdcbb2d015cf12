"""Decided samples keep their pace, and what is small does not wait for what is large."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge.paced import Paced
from proxy.bridge.sample import Held
from proxy.bridge.tuning import TUNING

RATE = 100_000.0


def test_what_is_large_goes_at_the_pace():
    """Each once what went before it is over."""
    paced = lane((0, 50_000), (1, 20_000), (2, 50_000))
    assert sent(paced) == [(0.0, 0), (0.5, 1), (0.7, 2)]


def test_what_is_small_waits_for_small_ones_only():
    """And what is large waits for both."""
    paced = lane((0, 50_000))
    assert sent(paced, until=0.0) == [(0.0, 0)]
    for number, size in ((1, 50_000), (2, 1000), (3, 1000)):
        paced.put(number, held(size, f"key/{number}"), size)
    assert sent(paced) == [(0.0, 2), (0.01, 3), (0.52, 1)]


def test_samples_of_one_key_stay_in_order():
    """A small one follows a large one of its key; what goes to one robot alone has a key of its own."""
    paced = Paced(RATE)
    for number, size, to in ((0, 50_000, ""), (1, 100, ""), (2, 100, "ab")):
        paced.put(number, held(size, "key", to), size)
    assert [number for _, number in sent(paced)] == [2, 0, 1]
    paced.put(3, held(100, "key"), 100)
    assert paced.take(10.0)[0] == 3


def test_without_a_pace_all_go_at_once_in_order():
    """The limits are no limits of bytes, or nothing is decided."""
    paced = lane((0, 50_000), (1, 100), (2, 50_000), rate=None)
    assert sent(paced) == [(0.0, 0), (0.0, 1), (0.0, 2)]


def test_nobody_waits_for_what_has_left():
    """Neither small samples nor large ones; what goes next has its time again."""
    paced = lane((0, 50_000), (1, 1000), (2, 50_000), (3, 1000))
    assert sent(paced, until=0.0) == [(0.0, 1)]
    paced.catch_up(0.001)
    assert sent(paced, 0.001) == [(0.001, 3), (0.011, 0), (0.511, 2)]


def test_a_thread_that_wakes_a_little_late_for_each_keeps_the_pace():
    """Small ones or large ones: else more came than went, and all that waited waited longer and longer."""
    for size in (40, 4000):
        paced = lane(*((number, size) for number in range(1000)))
        late = 0.75 * size / RATE if size == 40 else TUNING.made_up
        assert sent(paced, late=late)[-1][0] <= 999 * size / RATE + 2.0 * late


def test_who_comes_late_makes_up_for_a_moment_only():
    """What was not sent before is no reason to send more than the pace allows now."""
    paced = lane(*((number, 100) for number in range(100)))
    went = [at for at, _ in sent(paced, 5.0)]
    assert went[:11] == [5.0] * 11
    assert went[-1] == 5.089


def test_what_passes_pushes_the_next_large_sample_back():
    """By what it takes, and no longer than is said; nothing small."""
    paced = Paced(RATE)
    paced.push_back(0.0, 1000, 0.05)
    paced.put(0, held(50_000, "a"), 50_000)
    assert paced.due() == 0.01
    paced.push_back(0.0, 50_000, 0.05)
    assert paced.due() == 0.05
    paced.put(1, held(10, "b"), 10)
    assert paced.due() == 0.0


@given(st.lists(st.tuples(st.integers(1, 60_000), st.sampled_from("abc"), st.floats(0.0, 0.3)), max_size=60))
def test_nothing_is_lost_and_no_more_goes_than_the_pace_allows(published):
    """Each goes once, each key in order; beyond one large sample and what is small, what went keeps the pace."""
    paced, now, went = Paced(RATE), 0.0, []
    for number, (size, key, pause) in enumerate(published):
        went += sent(paced, now, now + pause)
        now += pause
        paced.put(number, held(size, key), size)
    went += sent(paced, now)
    assert not paced
    assert sorted(number for _, number in went) == list(range(len(published)))
    for key in "abc":
        of = [number for _, number in went if published[number][1] == key]
        assert of == sorted(of)
    for i, (begin, _) in enumerate(went):
        for j in range(i, len(went)):
            size = sum(published[number][0] for _, number in went[i : j + 1])
            spare = 60_000 + 2 * (TUNING.quick_sample + TUNING.made_up) * RATE
            assert size <= RATE * (went[j][0] - begin) + spare + 1e-3


def lane(*samples, rate=RATE):
    """Samples of different keys that wait, each by number and size."""
    paced = Paced(rate)
    for number, size in samples:
        paced.put(number, held(size, f"key/{number}"), size)
    return paced


def held(size, key, to=""):
    """What ingress holds of a sample."""
    return Held(None, None, key, size, None, to)


def sent(paced, now=0.0, until=1e9, late=0.0):
    """Send what waits, each as soon as it may go or so much later, up to a time; return when which went."""
    went = []
    while (due := paced.due()) is not None and max(now, due) <= until:
        now = max(now, due + late * (due > now))
        number, sample = paced.take(now)
        paced.sent(now, sample.size)
        went.append((round(now, 9), number))
    return went
