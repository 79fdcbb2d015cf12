"""Robots come, go, part and meet again; what they know of each other agrees in the end, whatever was lost."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from proxy.core.interface import events as ev
from proxy.core.protocol.messages import tag
from tests.proxy.core.mesh import STEP, Mesh
from tests.proxy.core.talk import SPEC

NAMES = {f"{letter * 8}01": f"r{number}" for number, letter in enumerate("abcd")}


def key_of(zid):
    return f"robot/{zid}/camera"


def talk(mesh, seconds):
    """All publish twice a second and subscribe to all cameras."""
    for _ in range(int(seconds * 2)):
        for zid in mesh.names:
            mesh.publish(zid, key_of(zid))
        mesh.run(0.5)


def begin(mesh):
    for zid in mesh.names:
        mesh.feed(zid, ev.InterestChanged(mesh.now, ("robot/*/camera",)))


def known(mesh, zid):
    """What a robot knows, in terms of ids."""
    view = mesh.cores[zid].view
    tags = view.members.tags
    return {
        "members": frozenset(view.peers) | {tag(zid)},
        "streams": {(tags[s.robot], s.key, s.generated) for s in view.streams},
        "wanted": {s.key: tuple(sorted((*view.subscribers.of(s), tags[s.robot]))) for s in view.streams},
    }


def assert_agreed(mesh, group):
    """All of a group know the same, and it is true."""
    view = known(mesh, group[0])
    assert all(known(mesh, zid) == view for zid in group)
    assert view["members"] == frozenset(map(tag, group))
    assert view["streams"] == {(tag(zid), key_of(zid), mesh.published[zid]) for zid in group}
    assert set(view["wanted"].values()) == {tuple(sorted(map(tag, group)))}
    for zid in group:
        core = mesh.cores[zid]
        assert all(
            peer.state.number == mesh.cores[peer.zid].gossip.states.state.number for peer in core.view.peers.values()
        )


def test_a_robot_comes_and_goes_with_its_own_token_alone(make_specs):
    """Somebody else shows its session under another name, and takes that back: nothing happens to it."""
    first, other = list(NAMES)[:2]
    mesh = Mesh(make_specs(), NAMES)
    begin(mesh)
    mesh.link([[first, other]])
    talk(mesh, 3.0)
    before = known(mesh, first)
    mesh.feed(first, ev.PeerAppeared(mesh.now, "forger", other))
    mesh.feed(first, ev.PeerGone(mesh.now, "forger", other))
    assert known(mesh, first) == before
    assert not mesh.cores[first].kept.copies.waiting
    mesh.feed(first, ev.PeerGone(mesh.now, NAMES[other], other))
    assert known(mesh, first)["members"] == {tag(first)}


def test_newcomers_are_in_everybodys_plan_within_one_state(make_specs):
    """One question, one answer: who was there knows the newcomer, and the newcomer all that was told long ago."""
    old, new = list(NAMES)[:3], list(NAMES)[3]
    mesh = Mesh(make_specs(), NAMES)
    begin(mesh)
    mesh.link([old])
    talk(mesh, 5.0)
    mesh.publish(new, key_of(new))
    mesh.link([[*old, new]])
    mesh.run(3 * STEP)
    for zid in old:
        peer = mesh.cores[zid].view.peers[tag(new)]
        assert (peer.state.subscriptions, list(peer.keys.values())) == (("robot/*/camera",), [key_of(new)])
        assert tag(new) in mesh.cores[zid].view.subscribers.of(next(mesh.cores[zid].view.streams.own()))
    mesh.run(4.0)
    assert_agreed(mesh, list(NAMES))


def test_who_leaves_is_out_of_the_plan_at_once(make_specs):
    """Its streams, its interest, its part of the limits."""
    mesh = Mesh(make_specs(), NAMES)
    begin(mesh)
    mesh.link([list(NAMES)])
    talk(mesh, 3.0)
    left = list(NAMES)[:3]
    mesh.link([left])
    for zid in left:
        assert known(mesh, zid)["members"] == frozenset(map(tag, left))
        assert {key for _, key, _ in known(mesh, zid)["streams"]} == set(map(key_of, left))


@settings(
    max_examples=max(settings().max_examples // 33, 1),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(seed=st.integers(0, 1000), loss=st.sampled_from((0.0, 0.2, 0.5)), clones=st.sampled_from((1, 2, 3)))
def test_after_a_partition_all_views_agree(make_specs, seed, loss, clones):
    """Two and two part, go on, and meet again; digests, states, questions and answers get lost; names may be shared."""
    names = {zid: "r0" if number < clones else name for number, (zid, name) in enumerate(NAMES.items())}
    mesh, everybody = Mesh(make_specs(limit="8 Mbit/s"), names, loss=loss, seed=seed), list(names)
    begin(mesh)
    mesh.link([everybody[:2], everybody[2:]])
    talk(mesh, 3.0)
    mesh.link([everybody])
    talk(mesh, 2.0)
    mesh.link([everybody[::2], everybody[1::2]])
    talk(mesh, 2.0)
    mesh.link([everybody])
    talk(mesh, 1.0)
    mesh.loss = min(loss, 0.2)
    mesh.run(25.0)
    mesh.loss = 0.0
    mesh.run(15.0)
    assert_agreed(mesh, everybody)
    for zid in everybody:
        assert len([peer for peer in mesh.cores[zid].view.peers.values() if peer.is_namesake]) == clones - 1


@pytest.mark.parametrize("text", [SPEC.format(limit="80 kbit/s", window=1.0)])
def test_a_last_digest_that_was_lost_is_made_up_for(make_specs, text):
    """The stream fell silent with it; some of what is known is told again in every digest."""
    a, b = list(NAMES)[:2]
    mesh = Mesh(make_specs(text=text), {zid: NAMES[zid] for zid in (a, b)})
    begin(mesh)
    mesh.link([[a, b]])
    talk(mesh, 2.0)
    mesh.loss = 1.0
    talk(mesh, 2.0)
    mesh.loss = 0.0
    mesh.run(12.0)
    assert_agreed(mesh, [a, b])
