"""Time on the air, by hand: 1 MB/s, 1 ms a frame, 90 B around a frame, 24 B around a message."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import ProblemError
from planner.airtime import FRAME_CARRIES, MESSAGE_HEADERS, OVERHEAD, Airtime


def air(**options):
    return Airtime(0.5, 1e6, **({"overhead": 1e-3} | options))


@pytest.mark.parametrize(
    ("measure", "size", "copies", "milliseconds"),
    [
        (air(), 1000, 1, 1 + 1.114),
        (air(), 1000, 3, 3 * 2.114),
        (air(), 1424, 1, 1 + 1.538),
        (air(), 1425, 1, 2 + 1.629),
        (air(), 10_000, 1, 7 + 10.654),
        (air(hops=2), 1000, 1, 2 * 2.114),
        (air(wifi="infrastructure"), 1000, 1, 2 * 2.114),
        (air(wifi="infrastructure", hops=2), 1000, 3, 12 * 2.114),
        (air(wifi="wired", overhead=0.0), 1000, 2, 2 * 1.114),
        (air(cast="multicast"), 1000, 3, 1 + 8 * 1.114),
        (air(cast="multicast", multicast_rate=1e6), 1000, 3, 2.114),
        (air(cast="multicast", wifi="infrastructure"), 1000, 3, 2.114 + 1 + 8 * 1.114),
        (air(cast="multicast", wifi="wired", overhead=0.0), 1000, 3, 1.114),
    ],
)
def test_a_message_takes_the_air_as_often_as_it_is_sent(measure, size, copies, milliseconds):
    """One unicast a receiver, one multicast for all at the basic rate, each twice through an access point."""
    assert measure.use(size, copies, own=True) * 1e3 == pytest.approx(milliseconds)


def test_the_overhead_of_a_frame_follows_from_802_11():
    """DIFS, mean backoff, preamble, SIFS and ACK; half a frame with a TCP acknowledgement of 90 B at 54 Mbit/s."""
    difs, backoff, preamble, acknowledged = 34e-6, 7.5 * 9e-6, 20e-6, 16e-6 + 28e-6
    frame = difs + backoff + preamble + acknowledged
    tcp = 0.5 * (frame + 90 * 8 / 54e6)
    assert frame + tcp == pytest.approx(OVERHEAD, rel=0.03)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"fraction": 1.5}, "airtime: fraction must be at most 1, not 1.5"),
        ({"phy_rate": 0.0}, "airtime: phy_rate must be a finite number > 0, not 0.0"),
        ({"multicast_rate": math.nan}, "airtime: multicast_rate must be a finite number > 0, not nan"),
        ({"hops": 0}, "airtime: hops must be a finite number > 0, not 0"),
        ({"overhead": -1.0}, "airtime: overhead must be a finite number >= 0, not -1.0"),
        ({"wifi": "mesh"}, "airtime: wifi must be one of adhoc, infrastructure, wired, not 'mesh'"),
        ({"cast": "anycast"}, "airtime: cast must be one of unicast, multicast, not 'anycast'"),
    ],
)
def test_a_channel_without_meaning_is_refused(options, complaint):
    """It is named with what is wrong."""
    with pytest.raises(ProblemError) as caught:
        Airtime(**({"fraction": 0.5, "phy_rate": 1e6} | options))
    assert str(caught.value) == complaint


@given(
    st.sampled_from(["adhoc", "infrastructure", "wired"]),
    st.integers(0, 10**6),
    st.integers(0, 10**6),
    st.integers(1, 9),
)
def test_a_message_takes_no_more_than_its_parts(wifi, size, further, copies):
    """Cutting a message in two saves nothing; whole frames and copies simply add up."""
    measure = air(wifi=wifi)
    parts = measure.use(size, copies, own=True) + measure.use(further, copies, own=True)
    assert measure.use(size + further, copies, own=True) <= parts + 1e-9
    assert measure.use(size, copies, own=True) == pytest.approx(copies * measure.use(size, 1, own=True))
    frames = [measure.use(n * FRAME_CARRIES - MESSAGE_HEADERS, 1, own=True) for n in (1, 2, 3)]
    assert frames == pytest.approx([n * frames[0] for n in (1, 2, 3)])
