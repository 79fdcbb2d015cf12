"""Who subscribes to what."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.view import subscribers
from proxy.core.view.subscribers import Interest, common, intersects

EXPRESSIONS = ("a/*", "a/**", "a/b", "**", "a/b$*", "a/@v/*", "*/c", "c", "a/$*c")
KEYS = ("a/b", "a/c", "a/bc", "a/@v/b", "c", "d/c", "a/b/c", "x")
CHANGES = st.lists(
    st.tuples(st.sampled_from("pqr"), st.lists(st.sampled_from((*EXPRESSIONS, "a//b")), max_size=4)), max_size=12
)


@given(CHANGES, st.lists(st.sampled_from(KEYS), min_size=1))
def test_the_answer_is_exact_under_changes(changes, asked):
    """Wildcards, parts of chunks and verbatim chunks: whatever was asked before, and whoever comes or goes."""
    kept, of = Interest(), {}
    for number, (tag, expressions) in enumerate(changes):
        kept.set(tag, expressions)
        of[tag] = expressions
        key = asked[number % len(asked)]
        right = tuple(sorted(tag for tag, keys in of.items() if any(intersects(each, key) for each in keys)))
        assert kept.wanting(key) == kept.wanting(key) == right
        assert kept.wanting(key, tag) == tuple(each for each in right if each != tag)


@given(
    st.sets(st.sampled_from(EXPRESSIONS), max_size=4),
    st.sets(st.sampled_from(EXPRESSIONS), max_size=4),
    st.sampled_from(KEYS),
)
def test_what_two_have_in_common_is_covered(subscriptions, keys, key):
    """By expressions of theirs: whatever both match, and where one includes the other nothing else."""
    found = common(subscriptions, keys)
    assert found <= subscriptions | keys
    both = any(intersects(each, key) for each in subscriptions) and any(intersects(each, key) for each in keys)
    assert both <= any(intersects(each, key) for each in found)


def test_the_narrower_one_is_what_is_in_common():
    """Of many subscriptions, and of those that take too long to compare, the keys are."""
    assert common(["**"], ["a/*"]) == common(["a/*"], ["**"]) == {"a/*"}
    assert common(["b/*"], ["a/*"]) == set()
    assert common(["a/**/b/**/c/**/d/**"], ["a/*"]) == {"a/*"}
    assert common([f"a/{n}" for n in range(1000)], ["a/*"]) == {"a/*"}


def test_many_changes_at_once_are_as_exact():
    """All answers are worked out anew then."""
    kept = Interest()
    kept.set("p", ["a/b"])
    assert kept.wanting("a/b") == ("p",)
    kept.set("q", ["a/*", *(f"k{n}" for n in range(20))])
    assert kept.wanting("a/b") == ("p", "q")


def test_answers_are_bounded(monkeypatch):
    """Keys of which many come once are not kept for ever."""
    monkeypatch.setattr(subscribers, "TUNING", replace(subscribers.TUNING, keys_answered=10))
    kept = Interest()
    kept.set("p", ["**"])
    assert all(kept.wanting(f"k{n}") == ("p",) for n in range(50))
    assert len(kept._wanting) <= 10


def test_expressions_that_take_ages_to_compare_are_not_compared():
    """Whoever asks so is taken to want everything."""
    assert not intersects("**/a/**/a/**/b", "a/" * 100 + "c")
    assert intersects("**/a/" * 30 + "b", "a/" * 100 + "c")
    assert intersects("x" + "$*a" * 30 + "b", "x" + "a" * 100 + "c")


def test_an_invalid_subscription_matches_nothing():
    """What a peer says is not trusted to be a key expression."""
    assert not intersects("a//b", "a/b")
    assert intersects("a/*", "a/b")
