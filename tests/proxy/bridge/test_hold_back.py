"""What is new waits for the copies of what came before, and for nothing else."""

import threading

import pytest

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.sample import origin_of
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import closing, plain_session
from tests.waiting import wait_until

BACK, HERE = "back0000", "here0000"


class Order:
    """A queue in which samples of `robot` and `other` arrive, and what is handed on."""

    def __init__(self, robot, other):
        self.stamper = {BACK: robot, HERE: other}
        self.names = {origin_of(session.new_timestamp()): tag for tag, session in self.stamper.items()}
        self.queue = HoldBack(lambda origin: self.names.get(origin, ""))
        self.handed = []

    def new(self, what, key="alarm/a", sender=BACK, size=1, stamp=None):
        """A new sample arrives; return its stamp."""
        stamp = stamp or self.stamper[sender].new_timestamp()
        if not self.queue.takes(key, stamp, size, lambda: self.handed.append(what)):
            self.handed.append(what)
        return stamp

    def copy(self, what, stamp, key="alarm/a"):
        """A copy arrives of what is not here yet, or (None) of what is."""
        self.queue.copied(key, stamp)
        if what is not None:
            self.handed.append(what)

    def flap(self, tag=BACK):
        self.queue.lost(tag)
        self.queue.found(tag)


@pytest.fixture
def order(stack, now):  # noqa: ARG001 - the clock stands still
    return Order(*(closing(stack, plain_session("peer")) for _ in range(2)))


def test_nothing_is_held_back_of_robots_that_were_there_all_the_time(order):
    """Nor of one that is here for the first time."""
    order.queue.found(BACK)
    order.new(1)
    assert (order.handed, order.queue.held) == ([1], 0)


def test_what_is_new_comes_after_the_copies(order):
    """From the return on, before anything is told of copies; each stream goes on when its own copies are here."""
    order.queue.lost(BACK)
    missed = [order.stamper[BACK].new_timestamp() for _ in range(2)]
    order.queue.found(BACK)
    order.new("a3")
    order.new("b3", "alarm/b")
    assert order.handed == []
    order.queue.note_backlog(BACK, 1, frozenset({"alarm/a"}))
    assert order.handed == ["b3"]
    order.new("b4", "alarm/b")
    order.copy("a1", missed[0])
    order.new("a4")
    order.copy("a2", missed[1])
    order.queue.note_backlog(BACK, 2, frozenset())
    order.new("a5")
    assert order.handed == ["b3", "b4", "a1", "a2", "a3", "a4", "a5"]
    assert order.queue.held == 3


def test_others_are_not_held_up(order):
    """Neither a robot that was there all the time, on the same key; who is not known may be the one that is back."""
    order.flap()
    order.new("other", sender=HERE)
    assert order.handed == ["other"]
    order.names.pop(origin_of(order.stamper[BACK].new_timestamp()))
    order.new("unknown")
    assert order.handed == ["other"]
    order.queue.note_backlog(BACK, 1, frozenset())
    assert order.handed == ["other", "unknown"]


def test_a_sample_whose_copy_comes_has_its_turn(order):
    """With all of its stream that is older, whether or not there are copies of that."""
    order.flap()
    order.new(1)
    second = order.new(2)
    order.new(3)
    order.queue.note_backlog(BACK, 1, frozenset({"alarm/a"}))
    order.copy(None, second)
    assert order.handed == [1, 2]
    order.queue.note_backlog(BACK, 2, frozenset())
    assert order.handed == [1, 2, 3]


def test_an_older_word_changes_nothing(order):
    """Words may overtake each other; one of a robot that was never lost says nothing."""
    order.flap()
    order.queue.note_backlog(HERE, 1, frozenset({"alarm/a"}))
    order.queue.note_backlog(BACK, 2, frozenset({"alarm/a"}))
    order.queue.note_backlog(BACK, 1, frozenset())
    order.new(1)
    order.new("other", sender=HERE)
    assert order.handed == ["other"]
    order.queue.note_backlog(BACK, 3, None)
    order.new("of any key", "alarm/b")
    assert order.handed == ["other"]
    order.queue.note_backlog(BACK, 4, frozenset())
    assert order.handed == ["other", 1, "of any key"]


@pytest.mark.parametrize("told", [None, frozenset({"alarm/a"})])
def test_a_robot_that_says_nothing_is_not_waited_for(order, now, told):
    """Neither when it is back, nor while copies are missing; as long as they come, it is."""
    order.flap()
    if told is not None:
        order.queue.note_backlog(BACK, 1, told)
    order.new(1)
    now[0] += 0.9 * TUNING.hold_back
    order.copy("copy", order.stamper[HERE].new_timestamp())
    now[0] += 0.9 * TUNING.hold_back
    order.queue.check(now[0])
    assert order.handed == ["copy"]
    now[0] += 0.2 * TUNING.hold_back
    order.queue.check(now[0])
    order.new(2)
    assert order.handed == ["copy", 1, 2]


def test_nothing_is_held_back_for_long(order, now):
    """However many copies there are."""
    order.flap()
    order.new("first")
    for _ in range(9):
        assert order.handed.count("first") == 0
        now[0] += TUNING.longest_hold_back / 9
        order.copy("copy", order.stamper[HERE].new_timestamp())
        order.queue.check(now[0] + 1e-6)
        order.new("later")
    assert order.handed == ["copy"] * 9 + ["first"]


def test_who_vanishes_again_is_waited_for_a_moment(order, now):
    """Its copies may go on soon; what is held back does not wait for a robot that stays away."""
    order.flap()
    order.queue.note_backlog(BACK, 1, frozenset({"alarm/a"}))
    order.new(1)
    order.queue.lost(BACK)
    assert order.handed == []
    now[0] += TUNING.hold_back
    order.queue.check(now[0])
    assert order.handed == [1]
    order.new(2)
    assert order.handed == [1, 2]
    order.queue.found(BACK)
    order.new(3)
    assert order.handed == [1, 2]
    order.queue.note_backlog(BACK, 2, frozenset())
    assert order.handed == [1, 2, 3]


def test_what_is_on_the_air_before_the_robot_is_linked_waits_too(order):
    """In broadcast; its origin is known from before, though nobody claims it now."""
    order.new(1)
    order.names.clear()
    order.queue.lost(BACK)
    order.new(2)
    order.queue.note_backlog(BACK, 1, frozenset({"alarm/a"}))
    order.queue.found(BACK)
    order.new(3)
    order.new("free", "alarm/b")
    assert order.handed == [1, "free"]
    order.queue.note_backlog(BACK, 2, frozenset())
    assert order.handed == [1, "free", 2, 3]


def test_there_is_room_for_so_many(order):
    """Of a stream that has no room any more all is handed on, in order."""
    order.flap()
    for number in range(BOUNDS.held_samples):
        order.new(number)
    assert order.handed == []
    order.new(BOUNDS.held_samples)
    assert order.handed == list(range(BOUNDS.held_samples + 1))


def test_of_the_robots_that_left_so_many_are_remembered(order):
    """Who left first is not waited for."""
    order.queue.lost(BACK)
    for number in range(BOUNDS.held_robots):
        order.queue.lost(f"gone{number}")
    order.queue.found(BACK)
    order.new(1)
    assert order.handed == [1]


def test_tokens_that_come_and_go_hold_up_nobody(order):
    """A robot is waited for so many times."""
    for number in range(int(BOUNDS.returns_at_once)):
        order.flap()
        order.new(number)
        order.queue.note_backlog(BACK, number + 1, frozenset())
    assert order.queue.held == BOUNDS.returns_at_once
    order.flap()
    order.new("last")
    assert order.handed[-1] == "last"
    assert order.queue.held == BOUNDS.returns_at_once


def test_what_is_held_back_is_handed_on_at_the_end(order):
    """Nothing that arrived is lost."""
    order.flap()
    order.new(1)
    order.queue.close()
    assert order.handed == [1]


def test_samples_without_a_timestamp_are_in_order_as_well(order):
    """Nobody knows who sent them."""
    order.flap()
    assert order.queue.takes("alarm/a", None, 1, lambda: order.handed.append(1))
    order.queue.note_backlog(BACK, 1, frozenset())
    assert order.handed == [1]


def test_what_overtook_older_samples_of_its_stream_is_handed_on_after_them(order):
    """A small one finds room sooner. A copy of an older one that is held brings that one, not the younger."""
    order.queue.lost(BACK)
    stamps = [order.stamper[BACK].new_timestamp() for _ in range(3)]
    order.queue.found(BACK)
    for place in (2, 0, 1):
        order.new(place, stamp=stamps[place])
    order.copy(None, stamps[0])
    assert order.handed == [0]
    order.queue.note_backlog(BACK, 1, frozenset())
    assert order.handed == [0, 1, 2]


def test_an_application_that_hangs_holds_up_only_what_comes_after_its_samples(order):
    """Not other robots, nor presence, nor who looks after the queue: all of them wait for nothing that it hands on."""
    order.flap()
    hangs, goes_on = threading.Event(), threading.Event()
    first = order.stamper[BACK].new_timestamp()

    def hand():
        hangs.set()
        goes_on.wait()
        order.handed.append("held")

    assert order.queue.takes("alarm/a", first, 1, hand)
    told = threading.Thread(target=order.queue.note_backlog, args=(BACK, 1, frozenset()))
    told.start()
    assert hangs.wait(30.0)
    after = threading.Thread(target=order.new, args=("new",))
    copied = threading.Thread(target=order.copy, args=("copy", order.stamper[BACK].new_timestamp()))
    for one in (after, copied):
        one.start()
    order.new("other key", "alarm/b")
    order.new("other robot", sender=HERE)
    order.queue.lost(HERE)
    order.queue.found(HERE)
    order.queue.check(0.0)
    assert order.handed == ["other key", "other robot"]
    goes_on.set()
    for one in (told, after, copied):
        one.join(30.0)
    assert order.handed[:3] == ["other key", "other robot", "held"]
    assert set(order.handed[3:]) == {"new", "copy"}


def test_whoever_leaves_waits_until_all_is_handed_on(order):
    """Also what another thread hands on: the session to applications is closed after that."""
    order.flap()
    hangs, goes_on = threading.Event(), threading.Event()
    assert order.queue.takes("alarm/a", order.stamper[BACK].new_timestamp(), 1, lambda: hangs.set() or goes_on.wait())
    order.new("last")
    told = threading.Thread(target=order.queue.note_backlog, args=(BACK, 1, frozenset()))
    told.start()
    assert hangs.wait(30.0)
    left = threading.Thread(target=lambda: order.queue.close() or order.handed.append("left"))
    left.start()
    left.join(0.1)
    assert left.is_alive()
    goes_on.set()
    wait_until(lambda: order.handed == ["last", "left"], what="the end")
    told.join(30.0)
    left.join(30.0)
