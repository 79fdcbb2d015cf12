"""What messages use, by hand and in general."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Constraint, ProblemError
from planner.airtime import Airtime
from planner.measures import Energy, Messages, Throughput

AMOUNTS = st.floats(1e-6, 1e6)
CABLES = st.sampled_from(["adhoc", "infrastructure", "wired"])
CASTS = st.sampled_from(["unicast", "multicast"])
MEASURES = st.one_of(
    st.builds(Throughput, AMOUNTS, AMOUNTS),
    st.builds(Messages, AMOUNTS, AMOUNTS),
    st.builds(Energy, AMOUNTS, AMOUNTS, AMOUNTS, st.floats(0.0, 1.0)),
    st.builds(
        Airtime,
        st.floats(0.01, 1.0),
        AMOUNTS,
        AMOUNTS,
        wifi=CABLES,
        cast=CASTS,
        hops=st.integers(1, 5),
        overhead=st.floats(0.0, 0.01),
    ),
)
SIZES = st.integers(0, 10**7)
COPIES = st.integers(1, 20)


@pytest.mark.parametrize(
    ("measure", "size", "copies", "used"),
    [
        (Throughput(1000.0), 100, 3, 300.0),
        (Messages(5), 100, 1, 1.0),
        (Messages(5), 10**6, 7, 1.0),
        (Energy(1.0, per_byte=2e-6), 1000, 1, 0.002),
        (Energy(1.0, per_byte=2e-6, per_message=1e-3), 1000, 3, 0.009),
    ],
)
def test_a_message_uses_what_its_measure_counts(measure, size, copies, used):
    """Bytes in every copy; one whatever it is; energy per byte and message of every copy."""
    assert measure.use(size, copies, own=True) == pytest.approx(used)


@pytest.mark.parametrize(
    ("measure", "limit"),
    [
        (Throughput(250_000.0), 125_000.0),
        (Throughput(1000.0, 2.0), 2000.0),
        (Messages(5, 2.5), 5.0),
        (Energy(0.5, 10.0, per_byte=1.0), 0.5),
        (Airtime(0.4, 1e6, 2.0), 0.8),
    ],
)
def test_a_measure_makes_its_constraint(measure, limit):
    """Rates and parts are per second, counts and energies per window."""
    assert measure.constraint("mine") == Constraint("mine", measure.window, limit)
    assert measure.limit == limit


@pytest.mark.parametrize(
    ("measure", "pace"),
    [
        (Throughput(250_000.0), 250_000.0),
        (Messages(5), math.inf),
        (Energy(1.0, per_byte=1.0), math.inf),
        (Airtime(0.5, 1e6), 500_000.0),
        (Airtime(0.5, 1e6, hops=2, wifi="infrastructure"), 125_000.0),
        (Airtime(0.5, 1e6, cast="multicast"), 62_500.0),
    ],
)
def test_a_measure_of_the_channel_tells_its_pace(measure, pace):
    """What bytes can go at, if nothing else took time; nothing is known of it from counts and batteries."""
    assert measure.pace == pytest.approx(pace)


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: Throughput(0.0), "throughput: rate must be a finite number > 0, not 0.0"),
        (lambda: Throughput(1.0, math.inf), "throughput: window must be a finite number > 0, not inf"),
        (lambda: Messages(-1), "messages: count must be a finite number > 0, not -1"),
        (lambda: Energy(math.nan, per_byte=1.0), "energy: joule must be a finite number > 0, not nan"),
        (lambda: Energy(1.0, per_byte=-1.0), "energy: per_byte must be a finite number >= 0, not -1.0"),
        (lambda: Energy(1.0), "energy: a message must cost something, per byte or per message"),
    ],
)
def test_a_measure_without_meaning_is_refused(make, complaint):
    """It is named with what is wrong."""
    with pytest.raises(ProblemError) as caught:
        make()
    assert str(caught.value) == complaint


@given(MEASURES, SIZES, SIZES, COPIES, COPIES)
def test_larger_messages_and_more_copies_never_use_less(measure, size, more, copies, further):
    """All measures are monotone, and nothing is negative."""
    used = measure.use(size, copies, own=True)
    assert 0.0 <= used <= measure.use(size + more, copies, own=True) * (1.0 + 1e-12)
    assert used <= measure.use(size, copies + further, own=True) * (1.0 + 1e-12)


@given(st.one_of(st.builds(Throughput, AMOUNTS), st.builds(Energy, AMOUNTS, AMOUNTS, AMOUNTS)), SIZES, COPIES, COPIES)
def test_copies_add_up(measure, size, copies, further):
    """Two groups of receivers use together what each uses."""
    together = measure.use(size, copies + further, own=True)
    assert together == pytest.approx(measure.use(size, copies, own=True) + measure.use(size, further, own=True))


@given(MEASURES, SIZES, COPIES)
def test_others_use_the_same_of_what_is_shared_and_nothing_of_our_own(measure, size, copies):
    """Only energy is private."""
    others = measure.use(size, copies, own=False)
    assert others == (0.0 if measure.private else measure.use(size, copies, own=True))
    assert measure.private == (measure.kind == "energy")
