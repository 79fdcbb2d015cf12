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


def test_of_all_called_for_one_sample_exactly_one_takes_it_even_when_the_owner_changes_meanwhile():
    """What took over after the first call leaves the sample to whom it belonged."""
    for order in (["k/*", "k/a"], ["k/a", "k/*"]):
        owners = Owners()
        owners.add("k/*")
        owners.add("k/a")
        first = owners.takes(order[0], "k/a")
        owners.discard("k/*")
        assert [first, owners.takes(order[1], "k/a")].count(True) == 1
        assert owners.takes("k/a", "k/a")
        assert not owners.takes("k/*", "k/a")


def test_samples_of_one_key_in_a_row_are_taken_once_each():
    """Round after round, whoever owns the key takes it."""
    owners = Owners()
    for expression in ("**", "k/*", "k/a"):
        owners.add(expression)
    calls = [(name, owners.takes(name, "k/a")) for _ in range(3) for name in ("k/*", "**", "k/a")]
    assert [name for name, taken in calls if taken] == ["**"] * 3


def test_the_first_call_for_a_query_is_the_first_whoever_else_is_called():
    """A query that reaches only some of those that match, and one that reaches all, have one first call each."""
    owners = Owners()
    for expression in ("q/*", "q/a", "**"):
        owners.add(expression)
    everybody, some = ("q/*", "q/a", "**"), ("q/a",)
    for called in (everybody, some, some, everybody, everybody, some):
        assert [owners.first(name, "q/a") for name in called].count(True) == 1


def test_a_call_after_a_change_is_a_first_one():
    """What one round left over does not swallow a query once something else is declared."""
    owners = Owners()
    owners.add("q/*")
    owners.add("q/a")
    assert owners.first("q/a", "q/a")
    owners.discard("q/a")
    assert owners.first("q/*", "q/a")
