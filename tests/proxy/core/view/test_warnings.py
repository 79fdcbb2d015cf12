"""What does not fit together is said."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Notice
from proxy.core.model.mode import Mode
from proxy.core.model.settings import UNICAST, broadcast
from proxy.core.protocol.messages import State

HERE = broadcast("224.0.0.226:7449")
AIRTIME = """
[[constraint]]
kind = "airtime"
limit = "5 %"
rate = "6 Mbit/s"
cast = "{cast}"
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = {{ kind = "video" }}
"""


def meet(talk, transport):
    talk.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    return talk.tell(ev.StateHeard(0.1, State("r2", "z-r2", "enforce", "", transport=transport)))


@pytest.mark.parametrize(("ours", "theirs"), [(HERE, UNICAST), (UNICAST, HERE), (HERE, broadcast("224.0.0.227:7449"))])
def test_a_robot_on_another_transport_is_named(make_talk, ours, theirs):
    """It is said loudly once, and stays in the status."""
    talk = make_talk(transport=ours)
    loud = [c for c in meet(talk, theirs) if isinstance(c, Notice) and c.level == "error"]
    text = (
        f"robot r2 has mesh.transport {theirs}, this one {ours}: what one of them broadcasts does not reach the other"
    )
    assert [notice.text for notice in loud] == [text]
    assert not [c for c in meet(talk, theirs) if isinstance(c, Notice) and c.level == "error"]
    assert talk.core.status(1.0)["warnings"] == [text]
    assert talk.core.status(1.0)["peers"][0]["transport"] == theirs


def test_what_a_robot_has_logged_is_for_few_reasons(make_talk):
    """Whatever it calls itself and says: the log has so many lines for each reason, and no more."""
    talk = make_talk()
    for number in range(3):
        talk.tell(ev.PeerAppeared(0.0, f"x{number}", f"z-{number}"))
        talk.tell(ev.StateHeard(0.1, State(f"x{number}", f"z-{number}", "enforce", "", transport=f"{number}")))
        talk.tell(ev.PeerGone(0.2, f"x{number}", f"z-{number}"))
    talk.tell(ev.PeerAppeared(0.3, "r1", "z-9"))
    assert [notice.fields["reason"] for notice in talk.all(Notice)] == [
        *(["presence", "transport", "presence"] * 3),
        *("presence", "namesake"),
    ]


def test_robots_on_one_transport_are_no_news(make_talk):
    """Nor is one that has not said yet how its samples travel."""
    talk = make_talk(transport=HERE)
    talk.tell(ev.PeerAppeared(0.0, "r3", "z-r3"))
    assert not [c for c in meet(talk, HERE) if isinstance(c, Notice) and c.level == "error"]
    assert talk.core.status(1.0)["warnings"] == []


@pytest.mark.parametrize(
    ("cast", "transport", "warned"),
    [("unicast", UNICAST, False), ("multicast", UNICAST, True), ("unicast", HERE, True), ("multicast", HERE, False)],
)
def test_airtime_that_counts_other_transmissions_is_named(make_talk, make_specs, cast, transport, warned):
    """A limit of airtime knows frames to one robot from frames to all."""
    talk = make_talk(make_specs(text=AIRTIME.format(cast=cast)), transport=transport)
    warnings = talk.core.status(1.0)["warnings"]
    assert bool(warnings) == warned
    assert all("correct the spec" in warning for warning in warnings)


SHARED = """
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"
window = 0.5
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "video" }
"""


def modes_of(talk, **modes):
    for name, mode in modes.items():
        talk.tell(ev.PeerAppeared(0.0, name, f"z-{name}"))
        talk.tell(ev.StateHeard(0.1, State(name, f"z-{name}", mode, "")))
    return [warning for warning in talk.core.status(1.0)["warnings"] if "mode" in warning]


def test_a_robot_that_sends_everything_among_others_that_enforce_is_named(make_talk, make_specs):
    """It would take the whole channel, and the others make room for it."""
    talk = make_talk(make_specs(text=SHARED))
    assert modes_of(talk, r2="shadow", r3="enforce") == [
        "robot r2 is in mode shadow: it sends everything, and this robot gives way to it; put all in one mode"
    ]
    assert modes_of(talk, r2="enforce") == []


def test_a_robot_that_sends_everything_says_so_itself(make_talk, make_specs):
    """Where others enforce; while a fleet is tried out in shadow nothing is wrong."""
    talk = make_talk(make_specs(text=SHARED))
    talk.tell(ev.ModeChanged(0.0, Mode.PASS))
    assert modes_of(talk, r2="shadow") == []
    assert modes_of(talk, r2="enforce", r3="enforce") == [
        "this robot is in mode pass: it sends everything, and r2, r3 give way to it; put all in one mode"
    ]


def test_modes_that_differ_harm_nobody_without_a_limit_that_all_share(make_talk, make_specs):
    """Then nobody gives way."""
    unlimited = SHARED[SHARED.index("[[information_type]]") :]
    assert modes_of(make_talk(make_specs(text=unlimited)), r2="shadow") == []


def test_a_limit_that_holds_little_beside_digests_is_named(make_talk, make_specs):
    """For as many robots as there are: alone there is nobody to tell anything."""
    talk = make_talk(make_specs(text=SHARED.replace("1 Mbit/s", "5 kbit/s")))
    assert talk.core.status(0.0)["warnings"] == []
    meet(talk, UNICAST)
    (warning,) = talk.core.status(1.0)["warnings"]
    assert warning.startswith('constraint "throughput": 32 % of it is for what the daemons of 2 robots tell each other')
