"""The split: the union of all robots' sends never exceeds a limit, whatever happens to digests."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from proxy.core.protocol.bid import UNIT, Segment, packed
from proxy.core.split.split import Split
from proxy.core.split.tuning import TUNING
from tests.proxy.core.split.flight import FLOOR, WINDOW, Flight, waits_for_turn

SMALL = (Segment(300, 150),)
FRAMES = (*SMALL, Segment(4160, 120, 1), Segment(4160, 110, 1), Segment(4160, 100, 2))
LIGHT = (Segment(1200, 120),)
STEPS = 500
some = settings(max_examples=max(1, settings().max_examples // 2))
seeds = st.integers(0, 10**9)


def settle(flight, seconds):
    """Digests get through, and nobody sends or bids anew."""
    until = flight.now + seconds
    while flight.now < until:
        flight.now += 0.01
        flight.exchange()


def fleet(robots, bid=SMALL, **kwargs):
    """A team that has agreed."""
    flight = Flight(1, robots, bids=lambda _: bid, rest=0.0, **kwargs)
    settle(flight, 4.0)
    return flight


def parts(flight):
    return {name: round(split.own_part.of(flight.clock(name)) * UNIT) for name, split in flight.splits.items()}


@some
@given(seeds, st.integers(1, 6), st.floats(0.0, 0.6), st.sampled_from([0.02, 0.2, 1.2]), st.sampled_from([0.02, 0.3]))
@example(seed=330, robots=5, loss=0.0, delay=0.02, pace=0.05)
@example(seed=17, robots=6, loss=0.1, delay=0.05, pace=0.05)
def test_the_union_holds_under_loss_delay_repetition_and_reordering(seed, robots, loss, delay, pace):
    """Robots send all that they may and change their bids at random: no window holds more than the limit.

    In the examples, slots are passed on by robots that hold two, and come back to who had them shortly before.
    """
    flight = Flight(seed, robots, loss=loss, delay=delay, pace=pace)
    for _ in range(STEPS):
        flight.step()
        assert flight.union() <= 1.0 + 1e-6


@some
@given(seeds, st.integers(1, 5), st.floats(0.0, 0.5), st.sampled_from([0.02, 0.2, 1.2]), st.sampled_from([0.05, 0.9]))
@example(seed=308966, robots=2, loss=0.0, delay=1.2, noticed=0.9)
def test_the_union_holds_whoever_comes_goes_parts_and_meets(seed, robots, loss, delay, noticed):
    """Beyond the limit only from when two teams meet until each has seen all of the other, and one window more.

    In the example one robot loses sight of the other for a moment, which notices nothing.
    """
    flight = Flight(seed, robots, loss=loss, delay=delay, noticed=noticed)
    for number in range(STEPS):
        flight.step()
        flight.happen(number)
        assert flight.now <= flight.met or flight.union() <= 1.0 + 1e-6


@some
@given(seeds, st.integers(2, 8), st.floats(0.0, 0.4), st.sampled_from([0.02, 0.2, 0.5]))
def test_all_agree_soon_and_use_the_limit_once_digests_get_through(seed, robots, loss, delay):
    """However they came to where they are, nothing of it lasts."""
    flight = Flight(seed, robots, loss=loss, delay=delay)
    for _ in range(STEPS // 5):
        flight.step()
    flight.loss, flight.demand = 0.0, {name: split.agreement.bid[1] for name, split in flight.splits.items()}
    settle(flight, 2.0 + 8 * delay)
    assert all(split.agreement.settled for split in flight.splits.values())
    assert sum(parts(flight).values()) >= UNIT * (1.0 - FLOOR) - 2 * robots - flight.in_transit()


@some
@given(seeds, st.integers(1, 5), st.floats(0.0, 0.5), st.sampled_from([0.02, 0.5]))
def test_nobody_is_silent(seed, robots, loss, delay):
    """Whoever comes, goes, parts and meets: a robot with small messages has some room at any time."""
    flight = Flight(seed, robots, loss=loss, delay=delay, bids=lambda _: FRAMES)
    for number in range(STEPS):
        flight.step()
        flight.happen(number)
        assert min(parts(flight).values()) >= min(UNIT * FLOOR // TUNING.newcomers, UNIT * (1.0 - FLOOR) // 8 // 12)


@some
@given(seeds, st.integers(2, 8), st.floats(0.3, 1.0), st.sampled_from([0.02, 0.2]))
def test_nobody_is_silent_for_long_however_much_is_lost(seed, robots, loss, delay):
    """Whose messages fit an equal part sends one after a second and a window at the latest, and the union holds."""
    flight = Flight(seed, robots, loss=loss, delay=delay, noticed=0.02, bids=lambda _: LIGHT, rest=0.0)
    last = dict.fromkeys(flight.splits, flight.now)
    for _ in range(STEPS):
        flight.now += 0.02
        flight.exchange()
        for name in flight.splits:
            assert flight.now - last[name] <= 1.0 + WINDOW + 0.1
            if flight.room(name) >= 0.04:
                flight.send(name, 0.04)
                last[name] = flight.now
        assert flight.union() <= 1.0 + 1e-6


def test_a_robot_alone_has_everything_once_settled():
    """One window later, as one that it never saw may just have sent; before, it has a newcomer's part."""
    split = Split("a", 0.0, (WINDOW,), floor=FLOOR, settled_at=1.0)
    split.advance(0.9, 0.0)
    assert split.own_part.of(0.9) == FLOOR / TUNING.newcomers
    assert split.due_at(0.9) == 1.0
    split.advance(1.0, 0.0)
    assert split.due_at(1.0) == 1.0 + WINDOW
    assert (split.own_part.of(1.9), split.own_part.of(1.0 + WINDOW)) == (FLOOR / TUNING.newcomers, 1.0 - FLOOR)


def test_equal_bids_have_equal_parts():
    """And all of the limit but the floor together."""
    assert parts(fleet(4)) == {f"r{i}": 2450 for i in range(4)}


def test_parts_follow_demand():
    """Who asks for more has more, once the others have heard it and a window has passed."""
    flight = fleet(2, (Segment(4500, 100),))
    flight.demand["r0"] = (Segment(8000, 100),)
    flight.demand["r1"] = SMALL
    settle(flight, 4.0)
    assert parts(flight) == {"r0": 8750, "r1": 1050}


def test_who_gives_uses_less_at_once_and_who_takes_waits():
    """In between, room is unused."""
    flight = fleet(2, (Segment(4500, 100),), delay=0.5)
    flight.demand["r0"], flight.demand["r1"] = (Segment(8000, 100),), SMALL
    settle(flight, 0.8)
    low = parts(flight)
    assert low["r1"] <= 4900
    assert low["r0"] == 4900
    settle(flight, 4.0)
    assert parts(flight)["r0"] == 8750


def test_a_robot_that_is_gone_leaves_its_part_to_the_others():
    """When they have agreed without it."""
    flight = fleet(4)
    flight.leave("r3")
    settle(flight, 4.0)
    assert set(parts(flight).values()) == {(UNIT - UNIT * FLOOR) // 3}


def test_a_newcomer_has_an_equal_part_left_at_once_and_takes_it_when_all_know_it():
    """Before, it has a part of the floor."""
    flight = fleet(3)
    flight.join("n")
    settle(flight, 0.25)
    assert parts(flight)["n"] == UNIT * FLOOR / TUNING.newcomers
    settle(flight, 3.0)
    assert set(parts(flight).values()) == {2450}


def test_a_robot_whose_digests_never_arrive_has_an_equal_part():
    """All others leave that to it, and it uses it once all have seen it."""
    flight = fleet(3)
    flight.mute.add("n")
    flight.join("n")
    settle(flight, 0.9)
    assert parts(flight)["n"] == UNIT * FLOOR / TUNING.newcomers
    settle(flight, 3.0)
    assert set(parts(flight).values()) == {2450}


def test_one_that_never_agrees_keeps_parts_as_they_were():
    """As one of other limits would, if it were taken for a member: bids do not change, and nobody is silenced."""
    flight = fleet(3, (Segment(2500, 120),))
    before = parts(flight)
    flight.kinds["n"] = b"other"
    flight.join("n")
    settle(flight, 8.0)
    after = parts(flight)
    assert all(0.5 * before[name] <= after[name] <= before[name] for name in before)


@pytest.mark.full
@pytest.mark.parametrize(
    ("robots", "delay", "least"),
    [
        (4, 0.02, 0.95),
        pytest.param(4, 0.2, 0.9, marks=pytest.mark.full),
        pytest.param(4, 1.0, 0.9, marks=pytest.mark.full),
        pytest.param(8, 0.1, 0.9, marks=pytest.mark.full),
    ],
)
def test_large_messages_go_by_turns(robots, delay, least):
    """Two frames fit in a window where small messages leave room: they are sent, by all alike, at any latency."""
    flight = fleet(robots, FRAMES, delay=delay)
    sent = dict.fromkeys(flight.splits, 0)
    windows = 40
    for _ in range(round(windows * WINDOW / 0.01)):
        flight.now += 0.01
        flight.exchange()
        for name in flight.splits:
            if flight.room(name) >= 0.416:
                flight.send(name, 0.416)
                sent[name] += 1
        assert flight.union() <= 1.0 + 1e-6
    frames = 2 if robots == 4 else 1
    assert sum(sent.values()) >= least * frames * windows
    assert max(sent.values()) <= 2 * min(sent.values())


def test_a_slot_is_kept_until_it_can_be_told_that_it_is_passed_on():
    """Else nobody has it: the next robot has not heard of it."""
    flight = fleet(2, (*SMALL, Segment(6000, 100, 2)))
    (holder,) = [split for split in flight.splits.values() if not waits_for_turn(split)]
    name, now = holder.agreement.own, flight.clock(holder.agreement.own)
    ends = holder.due_at(now)
    while ends <= now:
        now += 0.01
        ends = holder.due_at(now)
    told = now + 20.0
    for _ in range(100):
        now += 0.1
        assert not holder.advance(now, 0.02, told), name
        assert not waits_for_turn(holder)
        assert holder.due_at(now) > now, "nothing is looked at again before that"
    assert holder.advance(told + 0.01, 0.02, told)
    assert waits_for_turn(holder)


def test_small_messages_go_on_beside_a_large_one_whose_slot_was_passed_on():
    """What was sent in the slot does not count against what remains."""
    flight = fleet(4, FRAMES)
    waited = 0
    for moment in range(2000):
        flight.now += 0.01
        flight.exchange()
        for name in flight.splits:
            if flight.room(name) >= 0.416:
                flight.send(name, 0.416)
        if moment % 8 == 0:
            for name in flight.splits:
                waited += flight.room(name) < 0.002
                if flight.room(name) >= 0.002:
                    flight.send(name, 0.002)
    assert waited == 0


def test_a_slot_of_a_robot_that_is_gone_goes_to_the_others():
    """They agree on a table without it, in which turns begin anew."""
    flight = fleet(2, (*SMALL, Segment(6000, 100, 2)))
    (holder,) = [name for name, split in flight.splits.items() if not waits_for_turn(split)]
    flight.leave(holder)
    settle(flight, 5.0)
    assert list(parts(flight).values()) == [UNIT * (1.0 - FLOOR)]


def test_a_message_larger_than_the_limit_has_windows_for_itself():
    """Nothing else of its robot fits until it would have, and it keeps its turn that long."""
    flight = fleet(1, (Segment(UNIT, 100, 1),))
    flight.send("r0", 2.45)
    split, now = flight.splits["r0"], flight.clock("r0")
    assert split.own_part.free(now + 2.4 * WINDOW) == pytest.approx(0.0, abs=1e-9)
    assert split.own_part.free(now + 2.5 * WINDOW + 0.001) == pytest.approx(0.98)


def test_a_bid_changes_when_all_agree_and_it_differs_enough():
    """Neither noise nor haste keeps tables from being agreed on."""
    flight = fleet(2)
    split, now = flight.splits["r0"], flight.clock("r0")
    assert not split.bid(now, (Segment(330, 151),))
    assert not split.bid(now, (Segment(900, 150),))  # there is room for it as it is
    flight.demand["r0"] = (Segment(9000, 150),)
    assert split.bid(now, flight.demand["r0"])
    assert not split.bid(now + 9.0, SMALL)
    settle(flight, 1.5)
    assert not split.bid(flight.clock("r0"), SMALL)
    settle(flight, 1.0)
    assert split.bid(flight.clock("r0"), SMALL)


def test_the_first_bids_of_a_robot_follow_soon():
    """Its streams become known one by one."""
    flight = Flight(1, 2, bids=lambda _: SMALL, rest=0.0, delay=0.02)
    settle(flight, 0.6)
    flight.demand["r0"] = FRAMES
    settle(flight, 0.6)
    assert flight.splits["r0"].agreement.bid[1] == FRAMES


def test_a_bid_is_told_until_all_have_it():
    """Then digests name the table alone."""
    flight = fleet(3)
    told = flight.splits["r0"].announcement(flight.clock("r0"))
    assert told.bid is None
    assert told.table == told.agreed
    flight.join("n")
    flight.notice_all()
    assert flight.splits["r0"].announcement(flight.clock("r0")).bid == SMALL
    assert len(packed(FRAMES)) == 12


def test_a_bid_that_changes_nobodys_part_is_not_told():
    """However else it differs."""
    flight = fleet(2, (Segment(4000, 100),))
    split = flight.splits["r0"]
    assert not split.bid(flight.clock("r0") + 60.0, (Segment(4000, 180),))
    assert split.bid(flight.clock("r0") + 60.0, (Segment(9000, 180),))


def test_a_robot_whose_usual_messages_are_a_bit_larger_than_its_part_asks_anew():
    """However little they differ from what it asked for: else it is silent. Not where a few are larger."""
    flight = Flight(1, 2, bids=lambda _: SMALL, rest=0.0)
    flight.demand = {"r0": (Segment(867, 90, 4),), "r1": (Segment(9900, 80),)}
    settle(flight, 4.0)
    split = flight.splits["r0"]
    assert parts(flight)["r0"] == 867
    assert not split.bid(flight.clock("r0") + 60.0, (Segment(800, 90, 4),), usual=760)
    assert not split.bid(flight.clock("r0") + 60.0, (Segment(940, 90, 4),), usual=860)
    assert split.bid(flight.clock("r0") + 60.0, (Segment(940, 90, 4),), usual=900)


def test_a_large_team_keeps_equal_parts_and_says_nothing():
    """But for who could not send any of its messages in that."""
    flight = Flight(1, 4, bids=lambda _: (Segment(2000, 120), Segment(9000, 120, 4)), rest=0.0)
    quieten(flight)
    settle(flight, 4.0)
    assert all(
        split.agreement.silent and split.agreement.settled and not split.exchange.has_news(0.0)
        for split in flight.splits.values()
    )
    assert set(parts(flight).values()) == {(UNIT - UNIT * FLOOR) // 4}
    (split, *_) = flight.splits.values()
    assert split.bid(flight.now + 60.0, (Segment(4000, 120, 4),))
    assert not split.agreement.silent


def test_who_gave_up_asks_for_what_it_needs_as_soon_as_all_try_again():
    """Else all agree that nobody asks for anything, and each has next to nothing until its turn to ask comes."""
    flight = fleet(3)
    quieten(flight)
    for split in flight.splits.values():
        split.set_quiet(flight.now, quiet=False)
        assert split.agreement.pending
        assert split.agreement.bid[1] == ()
        assert split.bid(flight.now, SMALL)
    settle(flight, 2.0)
    assert all(split.agreement.formed for split in flight.splits.values())


@some
@given(seeds, st.integers(2, 6), st.sampled_from([0.02, 0.3]))
def test_a_team_that_gets_large_has_equal_parts_soon_and_no_window_over_the_limit(seed, robots, delay):
    """Whatever its robots had agreed on; those that see it first use no more of what they had."""
    flight = Flight(seed, robots, delay=delay)
    for _ in range(STEPS // 2):
        flight.step()
    seen = {name: flight.now + flight.rng.uniform(0.0, 0.9) for name in flight.splits}
    flight.demand = dict.fromkeys(flight.demand, SMALL)
    flight.bids = lambda _: SMALL
    for _ in range(STEPS):
        for name in [name for name, at in seen.items() if at <= flight.now]:
            flight.splits[name].set_quiet(flight.clock(name), quiet=True)
            del seen[name]
        flight.step()
        assert flight.union() <= 1.0 + 1e-6
    assert set(parts(flight).values()) == {(UNIT - round(UNIT * FLOOR)) // robots}


def quieten(flight):
    for name, split in flight.splits.items():
        split.set_quiet(flight.clock(name), quiet=True)


def test_the_guard_time_of_a_first_table_begins_when_it_was_announced():
    """Where nobody had sent more than it gives: however long it takes until all know that they agree."""
    splits = {tag: Split(tag, 0.0, (WINDOW,), floor=FLOOR, settled_at=1.0) for tag in "ab"}
    for tag, bid in (("a", (Segment(9000, 150),)), ("b", SMALL)):
        splits[tag].set_members(0.0, {"a", "b"} - {tag})
        splits[tag].advance(1.0, 0.0)
        splits[tag].bid(1.0, bid)
    for now in (3.0, 3.0, 3.9):
        told = {tag: split.announcement(now) for tag, split in splits.items()}
        for tag, split in splits.items():
            split.announced(now, told[tag])
        for tag, split in splits.items():
            (other,) = told.keys() - {tag}
            split.heard(now, other, told[other])
    part = splits["a"].own_part
    assert splits["a"].agreement.formed
    assert part.of(4.0 - 0.05) < 0.6
    assert part.of(4.0 + 0.05) > 0.8
