"""The widest of the wanted expressions get exactly what all of them get."""

import zenoh
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge.cover import Cover

EXPRESSIONS = ["a", "a/b", "a/*", "*/b", "a/**", "**", "b/$*c", "b/c", "@x/a", "@x/**", "a/@y", "a/@y/**"]
KEYS = ["a", "a/b", "a/c", "c/b", "a/b/c", "b/c", "b/xc", "d", "@x/a", "@x/b/c", "a/@y", "a/@y/z"]


def matched(expressions):
    parsed = [zenoh.KeyExpr(expression) for expression in expressions]
    return {key for key in KEYS if any(each.includes(key) for each in parsed)}


@given(st.lists(st.sets(st.sampled_from(EXPRESSIONS)), max_size=5))
def test_whatever_comes_and_goes_the_widest_match_the_same_keys_and_do_not_include_each_other(steps):
    """After each change the result is a subset of what is wanted, as wide, and without what is covered."""
    cover = Cover()
    for wanted in steps:
        widest = cover.update(wanted)
        assert widest.keys() <= wanted
        assert matched(widest) == matched(wanted)
        parsed = {name: zenoh.KeyExpr(name) for name in widest}
        assert not any(
            one.includes(other) for name, one in parsed.items() for also, other in parsed.items() if name != also
        )


def test_what_was_covered_stands_by_itself_when_its_cover_goes():
    """Chains of ever wider expressions are undone in any order."""
    cover = Cover()
    assert cover.update({"a/b"}) == {"a/b": False}
    assert cover.update({"a/b", "a/*"}) == {"a/*": False}
    assert cover.update({"a/b", "a/*", "**"}) == {"**": False}
    assert cover.update({"a/b", "**"}) == {"**": False}
    assert cover.update({"a/b"}) == {"a/b": False}
    assert cover.update(()) == {}


def test_tens_of_thousands_of_keys_are_placed_without_comparing_them_with_each_other():
    """Nothing without wildcards includes another one: what one peer declares costs no more than its own part."""
    cover = Cover()
    keys = {f"flood/{number}" for number in range(40_000)}
    assert cover.update(keys | {"a/**"}).keys() == keys | {"a/**"}
    assert cover.update(keys | {"a/**", "a/b"}).keys() == keys | {"a/**"}
    assert cover.update({"a/b"}).keys() == {"a/b"}
