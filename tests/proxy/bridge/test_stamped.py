"""Which samples left with our stamp."""

from dataclasses import replace

from proxy.bridge import stamped as stamped_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.stamped import Stamped


def test_what_left_is_known_by_key_and_stamp_until_many_more_did(monkeypatch):
    """At least as many as the bound says, at most twice as many."""
    monkeypatch.setattr(stamped_module, "BOUNDS", replace(BOUNDS, stamped_samples=3))
    stamped = Stamped()
    for stamp in range(1, 6):
        stamped.note("a", stamp)
        assert stamped.holds("a", stamp)
    assert stamped.holds("a", 1)
    assert not stamped.holds("b", 5)
    assert not stamped.holds("a", 6)
    stamped.note("a", 6)
    assert [stamped.holds("a", stamp) for stamp in range(1, 7)] == [False, False, False, True, True, True]
