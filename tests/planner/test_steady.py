"""The steady state: what each stream earns by how often it sends, and what the channel costs then."""

import numpy as np
import pytest

from planner.steady import INTERVALS, Steady, clearing_prices


def steady(*worths, use=1.0):
    """Streams of one message a second, each worth `w·(1 − e^−x)/x` at the interval x."""
    value = np.array([worth * (1.0 - np.exp(-INTERVALS)) / INTERVALS for worth in worths])
    rate = np.repeat(1.0 / INTERVALS[None], len(worths), axis=0)
    return Steady(np.arange(len(worths)), value, rate, np.full((len(worths), 1), use))


def test_what_fits_is_free():
    """Three streams of a message a second each, where three fit."""
    assert clearing_prices(steady(1.0, 2.0, 4.0), np.array([3.0])) == pytest.approx([0.0])


def test_at_the_price_streams_use_what_is_offered_and_no_more():
    """The sends that earn more than their price fit; those that earn as much do not fit any more."""
    streams = steady(1.0, 2.0, 4.0)
    for offered in (0.3, 1.0, 2.0, 2.9):
        (price,) = clearing_prices(streams, np.array([offered]))
        marginal, more = streams.marginal
        assert more[marginal > price].sum() <= offered < more[marginal >= price].sum() + 1e-9


def test_a_unit_costs_the_more_the_less_there_is():
    """And of larger messages fewer fit."""
    prices = [float(clearing_prices(steady(1.0, 2.0), np.array([offered]))[0]) for offered in (0.2, 0.5, 1.0, 1.9)]
    assert prices == sorted(prices, reverse=True)
    assert prices[-1] > 0.0


def test_what_a_stream_earns_by_one_more_send_falls_with_how_often_it_sends():
    """The marginal value is in the order of the intervals."""
    marginal, more = steady(1.0, 3.0).marginal
    assert (np.diff(marginal, axis=1) >= 0.0).all()
    assert more.sum(axis=1) == pytest.approx([1.0, 1.0])


def test_last_digits_choose_nothing():
    """Of intervals that pay alike the shortest is taken, and what is left by rounding is no gain."""
    streams = steady(1.0, 2.0)
    net = np.zeros_like(streams.value)
    net[0, 3:] = 1e-17
    net[1] = 1.0
    net[1, 5] += 1e-15
    interval, pays = streams.pays_best(net)
    assert interval.tolist() == [0, 0]
    assert pays.tolist() == [False, True]


def test_what_fits_but_for_rounding_is_free():
    """Three streams of a message a second each, where three fit but for the last digits."""
    assert clearing_prices(steady(1.0, 2.0, 4.0), np.array([3.0 * (1.0 - 1e-15)])) == pytest.approx([0.0])
