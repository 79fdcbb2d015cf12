"""One declaration for each wanted key expression, and none for any other."""

from dataclasses import replace

import pytest
import zenoh

from proxy.bridge import mirror as mirror_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.mirror import Mirror


class Made:
    """Records what is declared, as (expression, complete), and what was before each undeclaration."""

    def __init__(self):
        self.now = []
        self.before = []
        self.log = []

    def __call__(self, expression, complete):
        if expression == "refused":
            raise zenoh.ZError("no")
        if expression == "breaks":
            raise RuntimeError
        made = self

        class One:
            def undeclare(self):
                made.before.append(sorted(made.now))
                made.now.remove((expression, complete))

        self.now.append((expression, complete))
        self.log.append(expression)
        return One()


def test_it_follows_what_is_wanted():
    """New ones are declared, old ones taken back, those that stay are not touched."""
    made = Made()
    mirror = Mirror(made)
    assert mirror.update({"a": False, "b": True})
    assert not mirror.update({"a": False, "b": True})
    assert mirror.update({"b": True, "c": False})
    assert sorted(made.now) == [("b", True), ("c", False)]
    assert made.log.count("b") == 1
    assert mirror.expressions == ("b", "c")
    mirror.close()
    assert not made.now


def test_what_is_shown_is_taken_back_at_once():
    """Of what is refused nothing is remembered."""
    made = Made()
    mirror = Mirror(made)
    mirror.show("a")
    mirror.show("refused")
    assert made.log == ["a"]
    assert not made.now
    assert not mirror._refused
    assert mirror.update({"a": False})
    assert made.now == [("a", False)]


def test_what_finds_no_room_is_not_shown_and_not_logged(monkeypatch, caplog):
    """An application may declare thousands that are there for a moment: the log would have a line for each."""
    monkeypatch.setattr(mirror_module, "BOUNDS", replace(BOUNDS, declarations=1))
    made = Made()
    mirror = Mirror(made)
    mirror.update({"a": False})
    mirror.show("b")
    assert made.log == ["a"]
    assert not caplog.records


def test_a_changed_completeness_is_declared_anew():
    """A queryable that becomes complete is mirrored as complete."""
    made = Made()
    mirror = Mirror(made)
    mirror.update({"a": False})
    assert mirror.update({"a": True})
    assert made.now == [("a", True)]
    assert made.before == [[("a", False), ("a", True)]], "the new one is there before the old one goes"


def test_what_is_replaced_goes_also_where_others_cannot_be_declared():
    """Nothing of it is left behind."""
    made = Made()
    mirror = Mirror(made)
    mirror.update({"a": False})
    with pytest.raises(RuntimeError):
        mirror.update({"a": True, "breaks": False})
    assert made.now == [("a", True)]


def test_what_ended_and_is_wanted_again_ends_here_too():
    """Whoever follows it is told of both."""
    made = Made()
    mirror = Mirror(made)
    mirror.update({"a": False, "b": False})
    assert mirror.update({"a": False, "b": False}, {"a", "elsewhere"})
    assert made.log == ["a", "b", "a"]
    assert sorted(made.now) == [("a", False), ("b", False)]
    assert made.before == [[("a", False), ("b", False)]]


def test_what_zenoh_refuses_is_said_once_and_tried_again_when_wanted_anew(caplog):
    """A refused key expression neither stops the others nor fills the log."""
    mirror = Mirror(Made())
    for _ in range(3):
        mirror.update({"refused": False, "a": False})
    assert mirror.expressions == ("a",)
    assert len(caplog.records) == 1
    mirror.update({})
    mirror.update({"refused": False})
    assert len(caplog.records) == 2


def test_the_number_of_declarations_is_bounded(monkeypatch, caplog):
    """Beyond the bound declarations are refused and said."""
    monkeypatch.setattr(mirror_module, "BOUNDS", replace(BOUNDS, declarations=2))
    mirror = Mirror(Made())
    mirror.update(dict.fromkeys("abc", False))
    assert mirror.expressions == ("a", "b")
    assert "c is not mirrored" in caplog.text


def test_what_is_new_stands_for_a_while_before_what_is_stale_goes(now):
    """While one replaces the other both are there; what is wanted again meanwhile stays."""
    made = Made()
    mirror = Mirror(made, grace=0.05)
    mirror.update({"a/*": False, "b": False})
    mirror.update({"a/b": False})
    assert sorted(name for name, _ in made.now) == ["a/*", "a/b", "b"]
    assert mirror.leaving
    assert not mirror.update({"a/b": False, "b": False})
    now[0] += 0.05
    assert mirror.update({"a/b": False, "b": False})
    assert set(mirror.declared) == {"a/b", "b"}
    assert made.log.count("b") == 1
    assert not mirror.leaving


def test_without_grace_what_is_new_still_stands_first():
    """The order is the same."""
    made = Made()
    mirror = Mirror(made)
    mirror.update({"a/*": False})
    mirror.update({"a/b": False})
    assert made.before == [[("a/*", False), ("a/b", False)]]
