"""ns-3's Wi-Fi, message by message."""

from dataclasses import replace

import pytest

from studies.ns3.radio import AD_HOC, ALL, INFRASTRUCTURE, Radio

pytestmark = pytest.mark.full


def heard(radio, until):
    """All that arrives by then."""
    arrivals = []
    while found := list(radio.run(until)):
        arrivals += found
    return arrivals


def test_a_broadcast_takes_its_time_on_the_air_and_reaches_all_others_at_once():
    """2,048 B with their heads at 5.5 Mbit/s, not at the lowest rate."""
    with Radio(3) as radio:
        radio.send(0.5, 1, ALL, 2048, 7)
        arrivals = heard(radio, 1.0)
    assert [(arrival.id, arrival.receiver) for arrival in arrivals] == [(7, 0), (7, 2)]
    assert all(0.5 + 2048 * 8 / 5.5e6 < arrival.at < 0.504 for arrival in arrivals)


def test_it_stops_where_something_arrives_and_goes_on_from_there():
    """What is sent in answer leaves at once, not when the time asked for is over."""
    with Radio(2) as radio:
        radio.send(0.1, 0, 1, 100, 1)
        first = list(radio.run(9.0))
        radio.send(first[0].at, 1, 0, 100, 2)
        answer = list(radio.run(9.0))
        assert list(radio.run(9.0)) == []
    assert [(arrival.id, arrival.receiver) for arrival in first + answer] == [(1, 1), (2, 0)]
    assert answer[0].at < first[0].at + 0.01


def test_a_message_of_several_datagrams_arrives_once_and_whole():
    """UDP carries at most 64 kB, and Wi-Fi 2 kB a frame."""
    with Radio(3) as radio:
        radio.send(0.0, 0, ALL, 150_000, 1)
        arrivals = heard(radio, 2.0)
    assert sorted(arrival.receiver for arrival in arrivals) == [1, 2]
    assert all(arrival.at > 150_000 * 8 / 5.5e6 for arrival in arrivals)


def test_broadcasts_are_lost_as_often_as_asked_and_unicasts_are_repeated():
    """Wi-Fi acknowledges unicast frames, and sends them again."""
    sends = 400
    with Radio(2, replace(AD_HOC, loss=0.3), seed=3) as radio:
        for number in range(sends):
            radio.send(0.02 * number, 0, ALL if number % 2 else 1, 500, number)
        arrived = {arrival.id for arrival in heard(radio, 20.0)}
    broadcasts, unicasts = (sum(number % 2 == kind for number in arrived) for kind in (1, 0))
    assert 0.6 < broadcasts / (sends / 2) < 0.8
    assert unicasts > 0.97 * sends / 2


def test_the_same_seed_gives_the_same_flight_and_another_one_another():
    """Back-off and loss are drawn from it."""

    def flown(seed):
        with Radio(5, replace(AD_HOC, loss=0.2), seed=seed) as radio:
            for number in range(50):
                radio.send(0.01 * (number // 5), number % 5, ALL, 1000, number)
            return heard(radio, 2.0)

    first = flown(1)
    with Radio(3, INFRASTRUCTURE):
        pass
    assert flown(1) == first, "what was simulated before leaves nothing behind"
    assert flown(2) != first


def test_by_way_of_an_access_point_a_message_is_on_the_air_twice():
    """Robots of an infrastructure do not hear each other."""
    frame = 1400
    with Radio(3, INFRASTRUCTURE) as radio:
        radio.send(0.2, 0, 2, frame, 1)
        arrivals = heard(radio, 1.0)
    assert [(arrival.id, arrival.receiver) for arrival in arrivals] == [(1, 2)]
    assert arrivals[0].at > 0.2 + 2 * frame * 8 / 24e6


def test_by_way_of_an_access_point_nobody_asks_for_addresses():
    """Robots have met before: a first message takes no longer than a second one."""
    with Radio(2, INFRASTRUCTURE) as radio:
        for number in range(2):
            radio.send(float(number), 0, 1, 2048, number)
        first, second = heard(radio, 5.0)
    assert first.at == pytest.approx(second.at - 1.0, abs=5e-4)


def test_two_at_a_time_are_refused():
    """ns-3 has one simulator a process."""
    with Radio(2), pytest.raises(RuntimeError, match="one channel at a time"):
        Radio(2)
    with Radio(2) as again:
        assert list(again.run(0.1)) == []
