"""What nobody wants is not sent, and what somebody begins to want is sent at once."""

import pytest

from tests.waiting import wait_until

pytestmark = pytest.mark.system

KEY, SIZE, RATE = "robot/a/camera", 4000, 20
UNWANTED = 40
"""So many samples are published while nobody on another robot wants them."""
SOON = 1.0
"""When a sample has come at the latest after somebody subscribed, on a machine that has other things to do [s]."""


@pytest.mark.parametrize("transport", ["unicast", "broadcast"])
def test_nothing_is_sent_before_somebody_wants_it_and_then_at_once(team, transport):
    """An application of the same robot hears it all the time; when the last one elsewhere is gone, it ends."""
    speaking, listening, other = team(mesh=f'transport = "{transport}"')
    local = speaking.hear(KEY)
    speaker = speaking.say(KEY, size=SIZE, rate=RATE)
    wait_until(local.heard, what="samples on the robot itself")
    for _ in range(2):
        first, before = len(local.heard()), speaking.host.sent()
        wait_until(lambda first=first: len(local.heard()) >= first + UNWANTED, what="samples that nobody else wants")
        assert speaking.host.sent() - before < UNWANTED * SIZE / 4
        heard = listening.hear("robot/*/camera")
        wait_until(heard.heard, SOON, "a sample elsewhere")
        waited = heard.heard()[0]["heard"] - heard.asked
        print(f"{transport}: the first sample came {1000 * waited:.0f} ms after somebody had subscribed")
        wait_until(lambda heard=heard: len(heard.heard()) >= RATE, what="samples elsewhere")
        heard.close()
        wait_until(lambda: _receivers(speaking) == 0, what="the end of interest")
    speaker.stop()
    assert not other.status()["counts"]["in"]


def _receivers(robot):
    """How many robots want what this one publishes."""
    return sum(stream["receivers"] for stream in robot.status()["streams"] if stream["key"] == KEY)
