"""What robots announce of the split, and request again."""

import math
from dataclasses import replace

from proxy.core.protocol.bid import Segment
from proxy.core.split.split import Split
from proxy.core.split.tuning import TUNING
from tests.proxy.core.split.flight import FLOOR, WINDOW, waits_for_turn

SMALL = (Segment(300, 150),)


def team_of(tags, bid=SMALL, *, twice=False):
    """Robots that know each other, each of which asks for something; nobody has told anything yet."""
    splits = {tag: Split(tag, 0.0, (WINDOW,), floor=FLOOR, settled_at=1.0, twice=twice) for tag in tags}
    for tag, split in splits.items():
        split.set_members(0.0, set(tags) - {tag})
        if bid:
            split.bid(0.0, bid)
    return splits


def say(splits, now, by, *missed):
    """A robot tells what there is to tell, and all but some hear it."""
    told = splits[by].announcement(now)
    splits[by].announced(now, told)
    for tag, split in splits.items():
        if tag != by and tag not in missed:
            split.heard(now, by, told, now)
    return told


def test_agreeing_takes_two_digests_of_each_robot():
    """One with its bid, and one once it has those of all; nothing in between is worth telling."""
    splits = team_of("abcd")
    for tag in "abc":
        assert splits[tag].exchange.has_news(0.1)
        say(splits, 0.1, tag)
        assert not splits[tag].exchange.has_news(0.1)
    told = [say(splits, 0.2, tag) for tag in "dabc"]
    assert [each.bid for each in told] == [SMALL, None, None, None]
    assert all(split.agreement.formed for tag, split in splits.items())
    assert not any(split.exchange.has_news(0.3) for split in splits.values())


def test_who_asks_anew_has_not_to_wait_for_a_turn_as_who_answers():
    """It asks until that is told; the first bids of all are no such thing."""
    splits = team_of("ab")
    assert not splits["a"].exchange.asks
    for tag in "abab":
        say(splits, 0.1, tag)
    splits["a"].bid(60.0, (Segment(9000, 170),))
    assert splits["a"].exchange.asks
    say(splits, 60.1, "a")
    assert not splits["a"].exchange.asks
    assert not splits["b"].exchange.asks


def test_what_is_news_is_told_twice_where_all_hear_one_digest():
    """Once more soon after, and not a third time."""
    splits = team_of("ab", twice=True)
    first, later = say(splits, 0.1, "a", "b"), 0.1 + TUNING.repeat_after
    assert not splits["a"].exchange.has_news(0.1)
    assert splits["a"].due_at(0.1) == later
    assert splits["a"].exchange.has_news(later)
    assert say(splits, later, "a").bid == first.bid
    assert splits["a"].exchange.repeats_at == math.inf


def test_who_missed_a_digest_asks_and_only_who_is_asked_tells_again():
    """After a while, and once where others miss the same."""
    splits = team_of("abcd")
    say(splits, 0.1, "a")
    say(splits, 0.1, "b", "c", "d")
    say(splits, 0.1, "c")
    say(splits, 0.1, "d")
    say(splits, 0.2, "a")
    assert not any(splits[tag].exchange.has_news(0.5) for tag in "cd")
    first = min(splits["c"].due_at(0.5), splits["d"].due_at(0.5))
    asking = next(tag for tag in "cd" if splits[tag].exchange.has_news(5.0))
    told = say(splits, 5.0, asking)
    assert first < 5.0
    assert told.missing == 0b0010
    assert splits["b"].exchange.has_news(5.0)
    assert not splits["d" if asking == "c" else "c"].exchange.has_news(5.0)
    assert say(splits, 5.1, "b").bid == SMALL
    for tag in "cdab":
        say(splits, 5.2, tag)
    assert all(split.agreement.formed for split in splits.values())


def test_who_is_asked_again_and_again_asks_for_what_it_misses_all_the_same():
    """Answers are no reason to wait: one of eleven robots answered the others for ever, and none of them sent."""
    splits = team_of("abc")
    say(splits, 0.1, "a")
    say(splits, 0.1, "b")
    say(splits, 0.1, "c", "a")
    asked, now = [], 0.2
    while not asked and now < 20.0:
        now += 0.5
        told = splits["b"].announcement(now)
        splits["a"].heard(now, "b", replace(told, missing=0b001), now)
        if splits["a"].exchange.has_news(now):
            asked += [told.missing for told in [say(splits, now, "a", "b", "c")] if told.missing]
    assert asked == [0b100]


def test_who_has_nothing_to_ask_for_says_so_at_once():
    """Others wait for it."""
    splits = team_of("ab")
    splits["op"] = Split("op", 0.0, (WINDOW,), floor=FLOOR, settled_at=1.0)
    for tag, split in splits.items():
        split.set_members(0.0, splits.keys() - {tag})
    assert splits["op"].exchange.has_news(0.1)
    assert say(splits, 0.1, "op").bid == ()
    assert not splits["op"].exchange.has_news(0.1)
    say(splits, 0.2, "a")
    assert not splits["op"].exchange.has_news(0.2)
    say(splits, 0.2, "b")
    assert splits["op"].exchange.has_news(0.2)


def test_a_slot_that_was_passed_on_unheard_is_passed_on_again():
    """When its next turn should long be over."""
    splits = team_of("ab", (Segment(6000, 100, 2),))
    for tag in "abab":
        say(splits, 0.1, tag)
    (holder,) = [tag for tag, split in splits.items() if not waits_for_turn(split)]
    (other,) = splits.keys() - {holder}
    now = 0.1
    while not splits[holder].advance(now, 0.01):
        now += 0.1
    say(splits, now, holder, other)
    assert all(waits_for_turn(split) for split in splits.values())
    splits[holder].advance(now + 1.0, 0.01)
    assert not splits[holder].exchange.has_news(now + 1.0)
    splits[holder].advance(now + 8.0, 0.01)
    assert splits[holder].exchange.has_news(now + 8.0)
    say(splits, now + 8.0, holder)
    assert not waits_for_turn(splits[other])


def test_a_team_that_splits_again_says_so_at_once():
    """Also where nobody asks for anything else than before."""
    splits = team_of("ab")
    for tag in "abab":
        say(splits, 0.1, tag)
    assert not splits["a"].exchange.has_news(9.0)
    splits["a"].exchange.begin()
    assert splits["a"].exchange.has_news(9.0)
