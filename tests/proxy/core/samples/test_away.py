"""One robot that is away, and the copies that are kept for it."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.model.waiting import Waiting
from proxy.core.samples.away import Away, Copy, Leaving

TAG = "z-away"


def leaving(*subscriptions, reached=()):
    return Leaving("away", TAG, subscriptions, frozenset(reached), alike=True)


def copy(sample, key="alarm/a", *, scale=1.0, t_gen=None, most=2, delete=False):
    at = float(sample) if t_gen is None else t_gen
    return Copy(Waiting(sample, key, 100, at, scale, 5, markovian=False), TAG, 60.0, most, delete)


def test_of_too_many_of_a_key_the_least_valuable_is_too_many():
    """Of equals the oldest; other keys have room of their own."""
    away = Away(0.0, leaving())
    poor, rich, old, new = copy(1, scale=1.0), copy(2, scale=3.0), copy(3, "alarm/b"), copy(4, "alarm/b")
    assert [away.add(each) for each in (rich, poor, old, new)] == [None] * 4
    assert away.add(copy(5, scale=2.0)) is poor
    assert away.add(copy(6, "alarm/b")) is old


def test_a_deletion_is_the_last_that_is_too_many():
    """However little it is worth: what was deleted must not come back."""
    away = Away(0.0, leaving())
    first = copy(2, scale=9.0)
    for each in (copy(1, scale=0.0, delete=True), first):
        away.add(each)
    assert away.add(copy(3, scale=9.0)) is first


def test_a_copy_on_its_way_waits_no_longer_and_is_kept_until_it_is_answered():
    """One answer for each."""
    away = Away(0.0, leaving())
    first, second = copy(1), copy(2)
    away.add(first)
    away.add(second)
    away.hand(first)
    assert (away.has(first), list(away.waiting()), away.all(), away.count) == (False, [second], [second, first], 2)
    assert away.answer(1) is first
    assert away.answer(1) is None
    assert (away.count, away.keys) == (1, {"alarm/a"})
    away.remove(second)
    assert (away.count, away.keys, list(away.oldest())) == (0, frozenset(), [])


def test_a_copy_that_did_not_go_is_the_next_of_its_key_again():
    """Before those that were published after it."""
    away = Away(0.0, leaving())
    first, second = copy(1), copy(2)
    away.add(first)
    away.hand(first)
    away.add(second)
    away.answer(1)
    away.turn_back(first)
    assert list(away.waiting()) == [first, second]
    assert list(away.oldest()) == [first]


def test_when_the_robot_vanishes_what_was_on_its_way_waits_again_in_order():
    """By when samples were generated, then by their numbers: nobody knows whether they arrived."""
    away = Away(0.0, leaving())
    copies = [copy(number, t_gen=t_gen, most=9) for number, t_gen in ((4, 2.0), (3, 1.0), (5, 2.0))]
    for each in copies:
        away.add(each)
        away.hand(each)
    away.add(copy(6, t_gen=0.5, most=9))
    away.offer_again()
    assert [each.waiting.sample for each in away.waiting()] == [6, 3, 4, 5]
    assert away.answer(4) is None


def test_what_it_wants_changes_only_when_it_has_told():
    """Who vanishes before its subscriptions came wants what it wanted, and is away for as long."""
    away = Away(0.0, leaving("alarm/*"))
    away.appear()
    away.vanish(5.0, leaving())
    assert (away.since, away.back, away.wants("alarm/a")) == (0.0, False, True)
    away.appear()
    away.subscribe()
    away.vanish(9.0, leaving("camera/*"))
    assert (away.since, away.back, away.known) == (9.0, False, False)
    assert (away.wants("alarm/a"), away.wants("camera/left")) == (False, True)


def test_it_has_a_sample_of_a_key_for_certain_only_when_no_copy_of_that_waits():
    """So of `once` nothing is kept twice, and nothing is missed."""
    away = Away(0.0, leaving(reached=("alarm/a", "alarm/b")))
    waits = copy(1, "alarm/a")
    away.add(waits)
    assert away.reached == {"alarm/b"}
    away.hand(waits)
    assert away.reached == {"alarm/a", "alarm/b"}


STEPS = st.lists(st.tuples(st.sampled_from(("add", "hand", "answer", "refuse", "vanish")), st.sampled_from("ab")))


@given(STEPS)
def test_each_copy_waits_or_is_on_its_way_and_the_oldest_of_each_key_goes_first(steps):
    """Whatever happens, until it is answered for."""
    away, left = Away(0.0, leaving()), {}
    for number, (step, key) in enumerate(steps):
        oldest = next((each for each in away.oldest() if each.waiting.key == key), None)
        under_way = [each for each in away.all() if not away.has(each) and each.waiting.key == key]
        if step == "add":
            left[number] = made = copy(number, key, most=100)
            assert away.add(made) is None
        elif step == "hand" and oldest is not None:
            away.hand(oldest)
        elif step in ("answer", "refuse") and under_way:
            sent = away.answer(under_way[-1].waiting.sample)
            if step == "refuse":
                away.turn_back(sent)
            else:
                del left[sent.waiting.sample]
        elif step == "vanish":
            away.offer_again()
        assert {each.waiting.sample: each for each in away.all()} == left
        assert away.count == len(left)
        assert away.keys == {each.waiting.key for each in left.values()}
    away.offer_again()
    for each in list(away.oldest()):
        assert each.waiting.sample == min(n for n, one in left.items() if one.waiting.key == each.waiting.key)
