"""What goes without a search where the limits have room, as transcripts."""

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from proxy.core.coordination.budget import Budget
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.settings import broadcast
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag


@pytest.mark.parametrize(("coordination", "bounds"), [("announce", {"backlog": 2}), ("split", {"inbox_bytes": 4000})])
def test_while_the_limits_have_room_for_all_none_leaves_for_want_of_a_place(make_aggregated, coordination, bounds):
    """What is being decided and all that wait go at once, in order, without a search."""
    talk = make_aggregated("sum", coordination=coordination, settle=0.0, **bounds)
    talk.tell(ev.PeerGone(0.05, "op", "zz-op"))
    talk.tell(ev.MatchingChanged(0.05, "robot/r1/camera", matching=True))
    samples = [talk.publish(5.0 + 0.01 * n)[0] for n in range(9)]
    sent = [command.sample for command in talk.all(Forward)]
    assert len(sent) >= 5
    assert sent == samples[: len(sent)]
    assert not talk.all(Drop)


def test_deletions_keep_their_place_when_all_go_at_once(make_aggregated):
    """Before what was published after them."""
    talk = make_aggregated("sum", backlog=1, allowance=0.05)
    first, _ = talk.publish(0.1)
    second, _ = talk.publish(0.2)
    deletion, _ = talk.publish(0.3, delete=True)
    third, _ = talk.publish(0.4)
    talk.publish(0.5)
    talk.publish(0.6)
    assert [command.sample for command in talk.all(Forward)][:4] == [first, second, deletion, third]


@hypothesis_settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=40)
@given(steps=st.lists(st.sampled_from(["sample", "unknown", "digest", "wait", "specs", "ask"]), max_size=25))
def test_what_others_sent_is_known_as_if_it_were_looked_for_each_time(make_talk, make_specs, steps):
    """However often it is asked for at one moment, whatever came in between, under whatever limits."""
    talk, now = make_talk(transport=broadcast("224.0.0.1:1")), 10.0
    budget, view = talk.core.budget, talk.core.view
    talk.tell(ev.PeerAppeared(now, "r2", "z-r2"))
    camera = (StreamState(1, "robot/r2/camera", "camera", 0.1),)
    talk.tell(
        ev.StateHeard(now, State("r2", "z-r2", "enforce", "", camera, ("**",), transport=view.settings.transport))
    )
    for count, step in enumerate(steps, start=1):
        size = 100 * count
        if step == "sample":
            talk.tell(ev.SampleHeard(now, "robot/r2/camera", size, "z-r2", None, None))
        elif step == "unknown":
            talk.tell(ev.SampleHeard(now, "other", size, "z-r2", None, None))
        elif step == "digest":
            news = StreamDigest(1, count, count, now, now, size, 1.0)
            talk.tell(ev.DigestHeard(now, Digest("r2", tag("z-r2"), now + 1e-4 * count, 0, 0, (news,))))
        elif step == "specs":
            talk.tell(ev.SpecsChanged(now, make_specs(limit=f"{count} kB/s", window=0.1 * count)))
        elif step == "wait":
            now += 0.3
        fresh = Budget(view, talk.core.coordination)
        fresh.set_limits(budget.limits)
        fresh._others._earlier.extend(budget._others._earlier)
        assert budget.others(now) == fresh.others(now)


def test_small_samples_go_whatever_another_robot_claims(make_talk, make_specs):
    """It says that it has sent ten limits, or is about to send what is worth a million times as much."""
    talk = make_talk(make_specs("1 Mbit/s"))
    talk.want(0.0)
    talk.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    camera = (StreamState(1, "robot/r2/camera", "camera", 0.05, 0.0, 60_000),)
    talk.tell(ev.StateHeard(0.0, State("r2", "z-r2", "enforce", "", camera, ("**",), number=1)))
    for n in range(1, 61):
        now = 0.1 * n
        news = StreamDigest(1, 3 * n, 2 * n, now, now, 60_000, 1e6)
        digest = Digest("r2", tag("z-r2"), now, 20 * n, 1_200_000 * n, (news,), state=1)
        talk.tell(ev.DigestHeard(now, digest))
        _, commands = talk.publish(now + 0.01, size=100)
        for decide in commands:
            if isinstance(decide, Decide):
                talk.answer(now + 0.02, decide, send=False)
    assert len(talk.all(Forward)) >= 50
