"""What keys do."""

import pytest

from proxy.top.view import KEYS, View

ROWS = [
    {"key": "b/camera", "unsent": 1.0, "made": 5.0, "age": None, "type": "camera"},
    {"key": "a/pose", "unsent": 3.0, "made": 20.0, "age": 0.5, "type": "pose"},
    {"key": "c/alarm", "unsent": None, "made": 1.0, "age": 2.0, "type": "alarm"},
]


def pressed(*keys, **state):
    view = View(**state)
    for key in keys:
        view.press(key)
    return view


def order(view):
    return [row["key"][0] for row in view.chosen(ROWS, "key")]


def test_what_is_not_sent_comes_first_and_what_is_not_known_last():
    """That is what matters."""
    assert order(View()) == ["a", "b", "c"]


@pytest.mark.parametrize(
    ("times", "sort", "rows"),
    [
        (1, "made", "abc"),
        (2, "sent", "abc"),
        (3, "age", "cab"),
        (4, "bytes", "abc"),
        (5, "name", "abc"),
        (6, "not sent", "abc"),
    ],
)
def test_s_sorts_by_the_next_thing(times, sort, rows):
    """Round and round; equal rows are by name."""
    view = pressed(*"s" * times)
    assert (view.sort, "".join(order(view))) == (sort, rows)


def test_r_turns_the_order():
    """And again."""
    assert order(pressed("r")) == ["c", "b", "a"]
    assert order(pressed("r", "r")) == ["a", "b", "c"]
    assert order(pressed("r", sort="name")) == ["c", "b", "a"]


def test_a_filter_is_typed_and_taken_back():
    """Keys are letters meanwhile, whatever they do otherwise."""
    view = pressed("/", *"Qam", "backspace", "up")
    assert (view.filter, view.typing, view.done) == ("Qa", True, False)
    assert order(pressed("/", *"POS", "enter")) == ["a"]
    assert pressed("/", "x", "enter").typing is False
    assert pressed("/", "x", "esc").filter == pressed("/", "x", "enter", "esc").filter == ""
    assert pressed("/", "ctrl-c").done


def test_rows_scroll_as_far_as_there_are_any():
    """Never beyond, and one page with one key."""
    view = pressed("up")
    assert view.at == 0
    for key, at in (("down", 1), ("j", 2), ("k", 1), ("pagedown", 11), ("pageup", 1), ("end", 15), ("home", 0)):
        view.press(key)
        view.settle(20, 5)
        assert view.at == at


def test_the_mark_stays_on_its_robot():
    """Wherever that goes when rows are sorted anew; enter opens it."""
    view = pressed("down", fleet=True)
    view.mark(["r1", "r2", "r3"])
    assert view.marked == "r2"
    view.mark(["r3", "r1", "r2"])
    assert (view.marked, view.at) == ("r2", 2)
    view.mark(["r3"])
    assert (view.marked, view.at) == ("r3", 0)
    view.press("enter")
    assert (view.robot, view.fleet) == ("r3", False)
    empty = View(fleet=True)
    empty.mark([])
    empty.press("enter")
    assert (empty.marked, empty.fleet) == (None, True)


def test_n_goes_from_robot_to_robot():
    """And begins anew after the last; nothing happens where there is none."""
    view = View(names=("r1", "r2"), fleet=True)
    shown = []
    for _ in range(3):
        view.press("n")
        shown.append(view.robot)
    assert (shown, view.fleet) == (["r1", "r2", "r1"], False)
    assert pressed("tab").robot is None


def test_q_quits_and_other_keys_switch():
    """What no key means does nothing."""
    assert pressed("q").done
    assert pressed("ctrl-c").done
    assert pressed("f").fleet
    assert pressed("a").all_streams
    assert pressed("Z") == View()


def test_help_is_left_by_any_key_that_does_not_scroll():
    """Which does nothing else."""
    assert pressed("?").help
    assert pressed("?", "down").help
    view = pressed("?", "q")
    assert (view.help, view.done) == (False, False)


def test_every_key_is_explained():
    """In the help of the screen and of the command."""
    for key in ("q", "f", "n", "enter", "a", "s", "r", "/", "?"):
        assert KEYS[key]
