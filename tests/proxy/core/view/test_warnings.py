"""What does not fit together is said."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Notice
from proxy.core.model.transport import UNICAST, broadcast
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
