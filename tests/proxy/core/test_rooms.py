"""Where all plan for all and news take long, each robot keeps to what all agree is its own."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner import Throughput
from proxy.core.limits import Limit
from proxy.core.rooms import WAIT, Rooms
from proxy.core.settings import CoreSettings
from proxy.core.stream import Generated
from proxy.core.view import SharedView
from proxy.core.wire import State
from studies.simulation.conditions import Conditions
from studies.simulation.flights import fly
from studies.simulation.missions import draw, scenario
from studies.simulation.usage import usage
from utility_specs import load_specs

SIZE = 1000
SPEC = """
[[information_type]]
name = "position"
keys = ["*/position"]
aggregation = "most_recent"
utility = { kind = "linear", slope = 0.2 }
"""


def limit_of(messages):
    measure = Throughput(float(messages * SIZE), 2.0)
    return Limit("channel", 2.0, float(messages * SIZE), measure)


@pytest.fixture(scope="module")
def specs(tmp_path_factory):
    path = tmp_path_factory.mktemp("specs") / "spec.toml"
    path.write_text(SPEC)
    return load_specs(path)


def views_of(specs, weights, latency, *, off=0.0):
    """The views of robots with a stream each; what they measure of the way is `off` by that part, either way."""
    robots = [f"r{i}" for i in range(len(weights))]
    views = []
    for place, own in enumerate(robots):
        view = SharedView(CoreSettings(own, f"{own}-zid", transport="broadcast g", coordination="overhear"), specs)
        view.set_interest(("*/position",))
        measured = latency * (1.0 + off * (-1) ** place)
        for number, robot in enumerate(robots):
            if robot != own:
                zid = f"{robot}-zid"
                view.add_peer(0.0, robot, zid)
                view.heard_state(0.0, State(robot, zid, "enforce", "", (), ("*/position",), transport="broadcast g"))
                peer = next(p for p in view.peers.values() if p.robot == robot)
                peer.offset.heard(1.0, 1.0 + measured)
                peer.offset.echoed(1.0, 1.0 + measured)
            stream = view.stream(0.0, robot, f"{robot}/position")
            for count in range(1, 5):
                stream.note_generated(count, Generated(float(count), SIZE, weights[number]))
        views.append(view)
    return views


def held(view, limit, now=5.0):
    rooms = Rooms(view)
    rooms.look(now, (limit,))
    return rooms.held(0, limit) if rooms.late else None


@hypothesis_settings(deadline=None, max_examples=25)
@given(
    weights=st.lists(st.floats(0.5, 4.0), min_size=2, max_size=5),
    messages=st.integers(1, 8),
    latency=st.floats(0.25, 1.5),
)
def test_what_robots_with_equal_views_hold_never_exceeds_the_limit(specs, weights, messages, latency):
    """However long news take; and while streams have use for it, all of it is held."""
    limit = limit_of(messages)
    parts = [held(view, limit) for view in views_of(specs, weights, latency)]
    assert sum(parts) <= limit.limit * (1 + 1e-4)
    assert sum(parts) >= 0.99 * SIZE


def test_streams_that_gain_alike_are_told_apart_by_their_names(specs):
    """What each robot measures a little differently moves no room."""
    limit = limit_of(2)
    parts = [held(view, limit) for view in views_of(specs, [1.0] * 5, 1.0, off=0.02)]
    assert sum(parts) == pytest.approx(limit.limit, rel=1e-4)


def test_while_news_are_quick_there_are_no_rooms(specs):
    """All of the limit is everybody's."""
    limit = limit_of(2)
    view = views_of(specs, [1.0, 1.0], 0.02)[0]
    assert held(view, limit) is None
    assert Rooms(view).held(0, limit) == limit.limit


def test_while_news_wait_on_a_full_channel_there_are_rooms(specs):
    """However quick they were before; and none any more when they do not."""
    limit = limit_of(1)
    rooms = Rooms(views_of(specs, [1.0, 2.0], 0.02)[0])
    rooms.look(5.0, (limit,), 0.5)
    assert rooms.late
    assert rooms.held(0, limit) == 0.0
    rooms.look(6.0, (limit,))
    assert not rooms.late


def test_who_gets_a_room_waits_until_the_others_can_know_and_who_loses_one_does_not(specs):
    """The other robot's samples become worth less, then more than ours again."""
    limit = limit_of(1)
    view = views_of(specs, [1.0, 2.0], 1.0)[0]
    rooms, other = Rooms(view), view.known("r1", "r1/position")
    rooms.look(5.0, (limit,))
    assert rooms.held(0, limit) == 0.0
    other.note_generated(5, Generated(5.0, SIZE, 0.1))
    rooms.look(6.0, (limit,))
    assert rooms.held(0, limit) == 0.0
    now = 6.0
    while now < 6.0 + WAIT + 2.0 * 1.0 + 0.5:
        now += 0.25
        rooms.look(now, (limit,))
    assert rooms.held(0, limit) == pytest.approx(limit.limit, rel=1e-4)
    other.note_generated(6, Generated(6.0, SIZE, 9.0))
    rooms.look(now + 0.5, (limit,))
    assert rooms.held(0, limit) == 0.0


def test_a_message_larger_than_the_limit_may_go_where_all_is_held(make_talk, make_specs):
    """It is sent when nothing else was, for it never fits a room of less."""
    talk = make_talk(make_specs(limit="8 kbit/s"))
    talk.want(0.0)
    offset = next(iter(talk.core.view.peers.values())).offset
    offset.heard(0.0, 0.5)
    offset.echoed(0.0, 0.5)
    talk.publish(0.1, size=5000)
    talk.publish(1.1, size=5000)
    gate = talk.core.gate
    gate.next(3.0, 99)
    assert gate.late
    for step in range(20):
        gate.next(3.5 + 0.25 * step, 100 + step)
    assert gate.fits(8.5, (5000.0,))
    gate.problem_limits(8.5)


def test_while_a_queue_drains_rooms_are_smaller(make_talk, make_specs):
    """In proportion, so that robots that do not hear of each other send less together."""
    talk = make_talk(make_specs(limit="80 kbit/s"), coordination="overhear")
    talk.want(0.0)
    gate = talk.core.gate
    for step in range(6):
        talk.publish(1.0 + 0.4 * step, size=1000)
    gate.waiting = 0.5
    gate.next(6.0, 99)
    assert gate.late
    assert gate.fits(6.0, (1000.0,))
    gate.limits = tuple(replace(limit, limit=0.1 * limit.limit) for limit in gate.lasting)
    assert not gate.fits(6.0, (1000.0,))


def test_at_a_latency_of_a_second_the_union_keeps_the_limit():
    """Ten robots, five messages in 2.5 s, 1 % lost; and most of what the limit allows is sent."""
    how = Conditions(coordination="overhear", transport="broadcast", limit=5, latency=1.0, loss=0.01, seconds=15.0)
    flown = draw(scenario("mixed"), 0, how)
    used = usage(flown, fly(flown, how, 0), how)
    assert used.exceeding == 0.0
    assert used.messages >= 1.2
