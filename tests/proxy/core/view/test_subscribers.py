"""Who wants a stream, who still gains by it, and in how many copies it goes on the air."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from proxy.core.protocol.messages import State, StreamDigest
from proxy.core.view import subscribers
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.subscribers import Interest, common, intersects
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import CAMERA, digest, meet

ONCE = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "once"
utility = { kind = "video" }
"""


def test_receivers_are_the_robots_that_subscribe(view):
    """Our own apps count for others' streams, Zenoh's matching for a plain node that wants ours."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    assert view.subscribers.count(own) == 0
    own.matching = True
    assert view.subscribers.count(own) == 1
    view.add_peer(0.0, "r3", "z-r3")
    view.heard_state(0.0, State("r3", "z-r3", "enforce", "", (), ("robot/**",)))
    meet(view, subscriptions=("robot/*/camera", "robot/r1/**"))
    assert view.subscribers.count(own) == 2
    others = view.streams.touch(0.0, "r2", CAMERA)
    assert view.subscribers.count(others) == 1
    view.subscribers.set_own(("robot/r2/*",))
    assert (view.subscribers.count(others), view.subscribers.copies(others)) == (2, 2)
    assert view.subscribers.copies_of("r2", CAMERA) == 2, "also if nothing but its key is known"
    assert view.subscribers.copies_of("r2", "robot/r2/lidar") == 2, "its own wish for it does not count"
    assert view.subscribers.copies_of("r2", "else/r2") == 1


def test_a_robot_of_which_only_its_token_is_known_costs_nothing(view):
    """Large samples wait for what it wants for a moment; fifty tokens would make fifty copies of each small one."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    meet(view, subscriptions=(own.key,))
    view.add_peer(1.0, "r3", "z-r3")
    view.add_peer(1.0, "r4", "z-r4")
    assert (view.subscribers.count(own), view.subscribers.copies(own)) == (1, 1)
    view.heard_state(1.1, State("r3", "z-r3", "enforce", "", subscriptions=(own.key,)))
    assert view.subscribers.copies(own) == 2


def test_what_a_router_relays_costs_the_way_to_it_and_to_each_robot(make_specs):
    """Nobody but a plain node behind the router: the way to it. Each robot that wants the stream: one copy more."""
    view = SharedView(CoreSettings("r1", "z-r1", relayed=True), make_specs())
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.matching = True
    assert (view.subscribers.count(own), view.subscribers.copies(own)) == (1, 1)
    meet(view, subscriptions=("robot/*/camera",))
    assert (view.subscribers.count(own), view.subscribers.copies(own)) == (1, 2)


def test_a_broadcast_sample_is_one_copy_for_all(make_specs):
    """How many want it does not matter; each robot's samples cost what its own transport makes of them."""
    group = broadcast("224.0.0.226:7449")
    view = SharedView(CoreSettings("r1", "z-r1", transport=group), make_specs())
    for robot, transport in (("r2", UNICAST), ("r3", group), ("r4", group)):
        view.add_peer(0.0, robot, f"z-{robot}")
        state = State(robot, f"z-{robot}", "enforce", "", (), ("robot/*/camera",), transport=transport)
        view.heard_state(0.0, state)
    streams = {robot: view.streams.touch(0.0, robot, f"robot/{robot}/camera") for robot in ("r1", "r2", "r3")}
    assert {robot: view.subscribers.count(stream) for robot, stream in streams.items()} == {"r1": 3, "r2": 2, "r3": 2}
    assert {robot: view.subscribers.copies(stream) for robot, stream in streams.items()} == {"r1": 1, "r2": 2, "r3": 1}
    view.gone(1.0, "z-r3")
    assert view.subscribers.copies(view.streams.touch(1.0, "r3", "robot/r3/camera")) == 2


def test_of_once_only_those_gain_that_were_sent_nothing_yet(make_specs):
    """Whoever joins later gets its first; one that left and is back, too. Own and others' streams alike."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs(text=ONCE))
    meet(view, subscriptions=("robot/**",))
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 10, 1.0))
    assert (view.subscribers.gaining(own), view.contention.competes(1.0, own)) == (("z-r2",), True)
    view.traffic.note_sent(own, 1, Sent(1.0, 1.0, 10, 1.0))
    assert (view.subscribers.gaining(own), view.subscribers.count(own), view.contention.competes(1.0, own)) == (
        (),
        1,
        False,
    )
    view.add_peer(2.0, "r3", "z-r3")
    view.heard_state(2.0, State("r3", "z-r3", "enforce", "", (), ("robot/**",)))
    assert view.subscribers.gaining(own) == ("z-r3",)
    view.gone(1.0, "z-r2")
    meet(view, subscriptions=("robot/**",))
    assert set(view.subscribers.gaining(own)) == {"z-r2", "z-r3"}
    view.heard_digest(3.0, digest(3.0, StreamDigest(7, 2, 1, 2.9, 2.5, 10, 1.0)))
    others = view.streams.touch(3.0, "r2", CAMERA)
    assert (view.subscribers.of(others), view.subscribers.gaining(others)) == (("z-r3",), ())


def test_a_plain_node_that_was_sent_something_gains_no_more_of_it(make_specs):
    """It has no name, so all such nodes are one."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs(text=ONCE))
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.matching = True
    assert view.subscribers.gaining(own) == ("",)
    view.traffic.note_sent(own, 1, Sent(1.0, 1.0, 10, 1.0))
    assert view.subscribers.gaining(own) == ()


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


def test_of_too_many_expressions_with_wildcards_all_is_meant():
    """Each of them would be compared with the key of each stream; those without are looked up."""
    few, many, exact = (
        [f"{letter}/{n}{end}" for n in range(1000)] for letter, end in (("a", "/*"), ("b", "/*"), ("c", ""))
    )
    kept = Interest()
    kept.set("p", few[: subscribers.TUNING.patterns] + exact)
    kept.set("q", many)
    assert kept.wanting("a/5/x") == ("p", "q")
    assert kept.wanting("a/999/x") == kept.wanting("c/1000") == ("q",)
    assert kept.wanting("c/999") == ("p", "q")
    kept.set("q", many[:2])
    assert kept.wanting("a/999/x") == ()
    assert kept.any_wanted(["c/*"], "q")
    assert kept.any_wanted(["c/7"], "q")
    assert not kept.any_wanted(["c/1000"], "q")
    assert not kept.any_wanted(["c/*"], "p")


def test_a_key_expression_as_a_key_is_compared_with_all():
    """An application may publish on one: then whoever has something in common with it wants it."""
    kept = Interest()
    kept.set("p", ["a/b", "c/*"])
    assert kept.wanting("a/*") == kept.wanting("*/b") == kept.wanting("a/b") == ("p",)
    assert kept.wanting("b/*") == ()


def test_expressions_that_take_ages_to_compare_are_not_compared():
    """Whoever asks so is taken to want everything."""
    assert not intersects("**/a/**/a/**/b", "a/" * 20 + "c")
    assert intersects("**/a/**/a/**/b", "a/" * 100 + "c")
    assert not intersects("x/$*a$*a$*b", "x/" + "a" * 20)
    assert intersects("x/$*a$*a$*b", "x/" + "a" * 200)
    assert not intersects("x/$*b", "x/" + "a" * 1000)
    assert intersects("**/a/" * 30 + "b", "a/" * 100 + "c")
    assert intersects("x" + "$*a" * 30 + "b", "x" + "a" * 100 + "c")


def test_an_invalid_subscription_matches_nothing():
    """What a peer says is not trusted to be a key expression."""
    assert not intersects("a//b", "a/b")
    assert intersects("a/*", "a/b")
