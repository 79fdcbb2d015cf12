"""Whole daemons whose link falls and comes back, on real sessions over loopback: each alarm arrives, once, in order."""

import pytest
import zenoh

from tests.proxy.counting import Counting
from tests.proxy.nodes import Heard
from tests.proxy.test_daemon import Robot, known
from tests.waiting import wait_until
from utility_specs import load_specs

SPECS = """
[[information_type]]
name = "alarm"
keys = ["alarm/**"]
aggregation = "sum"
utility = { kind = "step", lifetime = "5 min" }
[[information_type]]
name = "warning"
keys = ["warning/**"]
aggregation = "once"
utility = { kind = "step", lifetime = "5 min" }
[[information_type]]
name = "camera"
keys = ["camera/**"]
utility = { kind = "video" }
"""
LIMIT = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 0.5
"""
ALARMS = [f"alarm {number}" for number in range(20)]
BLOCK = zenoh.CongestionControl.BLOCK


@pytest.fixture
def make_specs(tmp_path):
    def make(text):
        path = tmp_path / "specs.toml"
        path.write_text(text)
        return load_specs(path)

    return make


def peers(robot):
    return {peer["robot"] for peer in robot.status()["peers"]}


def kept(robot):
    return robot.status()["kept"]


def taken(robot):
    """What a daemon subscribes to on the side of its applications."""
    return robot.status()["daemon"]["observed"]


def of(heard, key):
    """The payloads that came on a key, in order."""
    return [sample.payload.to_string() for sample in heard.samples if str(sample.key_expr) == key]


def test_what_a_robot_missed_while_it_was_away_it_gets_when_it_is_back(stack, make_specs):
    """Each alarm in order, once, as it was published; the others get nothing twice, and a camera's images are past."""
    specs = make_specs(SPECS)
    first = Robot(stack, "r1", specs)
    relay = stack.enter_context(Counting(first.mesh))
    second = Robot(stack, "r2", specs, (relay.endpoint,))
    third = Robot(stack, "r3", specs, (first.mesh,))
    wait_until(lambda: peers(first) == {"r2", "r3"}, what="the team")
    away, here = Heard(second.node(), "**"), Heard(third.node(), "alarm/a")
    app = first.node()
    wait_until(lambda: kept(first)["keys"] == ["alarm/**", "alarm/a", "warning/**"], what="what both subscribe to")
    wait_until(lambda: "**" in taken(first), what="somebody to take it from the application")
    wait_until(lambda: app.put("alarm/a", "before") or known(first, "alarm/a") == 2, what="the stream")
    app.put("alarm/a", "last")
    wait_until(lambda: of(away, "alarm/a")[-1:] == of(here, "alarm/a")[-1:] == ["last"], what="both to hear")
    relay.cut()
    wait_until(lambda: peers(first) == {"r3"}, what="the loss")
    for text in ALARMS:
        app.put("alarm/a", text, attachment=text, encoding="text/plain;alarm", priority=zenoh.Priority.DATA_HIGH)
        for key in ("alarm/only", "camera/a", "warning/a"):
            app.put(key, text, congestion_control=BLOCK)
    wait_until(lambda: of(here, "alarm/a")[-1] == ALARMS[-1], what="the one that is here")
    assert away.samples[-1].payload.to_string() == "last"
    wait_until(lambda: kept(first)["in"] > 60, what="one copy of each for the one that is not")
    relay.mend()
    wait_until(lambda: peers(first) == {"r2", "r3"} and not kept(first)["for"], what="its return")
    app.put("alarm/a", "after")
    wait_until(lambda: of(away, "alarm/a")[-1] == of(here, "alarm/a")[-1] == "after", what="new ones")
    wait_until(lambda: ALARMS[-1] in of(away, "alarm/only") and of(away, "warning/a"), what="keys that wait apart")
    assert of(here, "alarm/a")[-22:] == ["last", *ALARMS, "after"]
    assert of(away, "alarm/a")[-22:] == ["last", *ALARMS, "after"]
    assert (of(away, "alarm/only"), of(away, "warning/a"), of(away, "camera/a")) == (ALARMS, ALARMS[:1], [])
    alarm = next(sample for sample in away.samples if sample.payload.to_string() == ALARMS[3])
    same = next(sample for sample in here.samples if sample.payload.to_string() == ALARMS[3])
    for each in ("key_expr", "encoding", "priority", "congestion_control", "express", "timestamp", "kind"):
        assert str(getattr(alarm, each)) == str(getattr(same, each))
    assert alarm.attachment.to_string() == ALARMS[3]
    # What was sent just before the loss was noticed is offered again, and left out: it had arrived.
    wait_until(
        lambda: kept(first)["by_reason"]["forwarded"] == 41 + second.status()["daemon"]["repeated"],
        what="what had arrived to be left out",
    )
    assert kept(first)["by_reason"]["dropped:once"] == 19
    assert (kept(first)["conserved"], first.status()["counts"]["conserved"]) == (True, True)


@pytest.mark.full
def test_what_nobody_saw_getting_lost_and_what_came_then_wait_for_room_under_the_limit(stack, make_specs):
    """The only robot that wants it is out of reach, and nobody knows at first: none is lost, in order, each once.

    A new alarm, for which there is room at once, comes after the copies that wait.
    """
    specs = make_specs(LIMIT + SPECS)
    first = Robot(stack, "r1", specs)
    relay = stack.enter_context(Counting(first.mesh))
    second = Robot(stack, "r2", specs, (relay.endpoint,))
    away = Heard(second.node(), "alarm/**")
    app = first.node()
    wait_until(lambda: kept(first)["keys"] == taken(first) == ["alarm/**"], what="what it subscribes to")
    relay.lose()
    for text in ALARMS[:5]:  # so small that no plan is against them
        app.put("alarm/a", text, congestion_control=BLOCK)
    wait_until(lambda: not peers(first), what="the loss")
    for text in ALARMS[5:]:
        app.put("alarm/a", text.ljust(1000), congestion_control=BLOCK)
    wait_until(lambda: kept(first)["in"] == len(ALARMS), what="a copy of each")
    relay.mend()
    wait_until(lambda: away.samples, what="the first copies")
    app.put("alarm/a", "after", congestion_control=BLOCK)
    wait_until(lambda: len(away.samples) > len(ALARMS), what="all of it")
    wait_until(lambda: not kept(first)["waiting"], what="the end")
    assert [text.strip() for text in of(away, "alarm/a")] == [*ALARMS, "after"]
    # The new one may have been kept, too: who was away had not told yet what it wants, or there was no room.
    assert kept(first)["by_reason"]["forwarded"] == kept(first)["in"] <= len(ALARMS) + 1
    assert kept(first)["conserved"]
