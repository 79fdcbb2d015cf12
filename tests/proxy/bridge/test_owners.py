"""Exactly one of several overlapping declarations answers for a key."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge import owners as owners_module
from proxy.bridge.owners import Owners

EXPRESSIONS = ["**", "a/*", "*/b", "a/b", "a/**", "**/b", "c"]


def test_the_oldest_that_matches_owns():
    """Newer declarations own only what no older one matches; nobody owns the rest."""
    owners = Owners()
    for expression in ("a/*", "a/**"):
        owners.add(expression)
    assert [owners.owner(key) for key in ("a/b", "a/b/c", "c")] == ["a/*", "a/**", None]
    owners.discard("a/*")
    assert owners.owner("a/b") == "a/**"


def test_key_expressions_of_queries_have_owners_too():
    """A query with wildcards belongs to the oldest declaration it reaches."""
    owners = Owners()
    owners.add("q/1")
    owners.add("q/*")
    assert owners.owner("q/**") == "q/1"


@given(st.lists(st.sampled_from(EXPRESSIONS), unique=True), st.lists(st.sampled_from(EXPRESSIONS)))
def test_a_key_has_an_owner_exactly_when_something_matches_it(added, discarded):
    """Whatever was added and discarded, a key is owned by one of those left, if any matches."""
    owners = Owners()
    for expression in added:
        owners.add(expression)
    for expression in discarded:
        owners.discard(expression)
    left = [expression for expression in added if expression not in discarded]
    owner = owners.owner("a/b")
    assert (owner in left) if [e for e in left if e != "c"] else owner is None


def test_the_cache_is_bounded(monkeypatch):
    """More keys than it remembers cost time, not memory, and change no answer."""
    monkeypatch.setattr(owners_module, "_CACHED", 4)
    owners = Owners()
    owners.add("k/*")
    for _ in range(2):
        assert [owners.owner(f"k/{i}") for i in range(10)] == ["k/*"] * 10
    assert len(owners._cache) <= 4
