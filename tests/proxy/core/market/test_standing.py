"""What others may just have sent of what nobody disputes."""

import pytest

from proxy.core.market.standing import Row, UnderWay


def row(*use):
    """A stream of which only the use counts here."""
    return Row(None, 0.0, 0.0, 1.0, use, tuple(0.0 for _ in use))


def test_what_is_under_way_grows_with_how_long_news_take():
    """In the mean it is what is sent meanwhile, and it deviates like what comes at random."""
    sending = UnderWay.of([(row(100.0), 0.1), (row(400.0), 0.5)], 1)
    assert sending == ((1800.0,), (420_000.0,))
    assert sending.beside((50.0,), 0.0) == (50.0,)
    assert sending.beside((50.0,), 0.01) == pytest.approx((50.0 + 18.0 + 64.8,), abs=0.1)


def test_what_a_message_uses_nothing_of_has_no_room_to_leave():
    """Nor where other limits are in force than those by which others were weighed."""
    sending = UnderWay.of([(row(100.0, 2.0), 0.1)], 2)
    assert sending.beside((0.0, 1.0), 0.01) == pytest.approx((0.0, 1.0 + 0.2 + 0.4**0.5 / 1.0))
    assert sending.beside((7.0,), 0.01) == (7.0,)
    assert UnderWay.of([], 1).beside((7.0,), 1.0) == (7.0,)
