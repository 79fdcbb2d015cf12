"""What decisions on a real network are worth: real daemons, links that lose packets, and the offline optimum."""

import pytest

from tests.system.flight import Camera, utility_share
from tests.waiting import wait_until

pytestmark = pytest.mark.system

CAMERAS = {name: Camera(f"robot/{name}/camera", size, 10) for name, size in (("a", 6000), ("b", 8000), ("c", 10_000))}
"""They publish 1.9 Mbit/s together."""
LIMIT = 800_000
SECONDS = 12.0
STALL = 0.04
"""Where a camera publishes so much too late, the machine was busy with something else, for daemons as well [s]."""
FLIGHTS = 4
"""So many are flown at most until the machine lets one be flown..."""
STALLED = 0.8
"""... and if it never did, this part of what is asked has to do."""


@pytest.mark.parametrize(
    ("transport", "loss", "least"),
    [("unicast", 0, 0.9), ("broadcast", 0, 0.9), ("unicast", 10, 0.75), ("broadcast", 10, 0.7)],
)
def test_a_flight_is_worth_most_of_what_it_could_be(team, transport, loss, least):
    """Whoever decides alone, on links that lose packets, the operator gets most of what the best plan gives."""
    robots = team("abcd", limit="800 kbit/s", mesh=f'transport = "{transport}"')
    for robot in robots:
        robot.host.lose(loss)
    for _ in range(FLIGHTS):
        share, late = flown(robots)
        print(f"{transport}, {loss} % of packets lost: {share:.1%} of the offline optimum; {late:.3f} s late")
        if late < STALL or share >= least:
            break
    assert share >= (least if late < STALL else STALLED * least)


def flown(robots):
    """Return what one flight gave as a share of the optimum, and by how much a camera was late at most [s]."""
    heard = robots[-1].hear("robot/*/camera")
    speakers = [
        robot.say(camera.key, size=camera.size, rate=camera.rate)
        for robot, camera in zip(robots, CAMERAS.values(), strict=False)
    ]
    wait_until(lambda: len({s["key"] for s in heard.heard()}) == 3, what="samples of all")
    begun = heard.heard()[-1]["heard"] + 3.0
    wait_until(lambda: heard.heard()[-1]["heard"] >= begun + SECONDS, 3 * SECONDS, "the end of the flight")
    for speaker in speakers:
        speaker.stop()
    heard.close()
    samples = [s for s in heard.heard() if s["heard"] >= begun]
    share = utility_share(CAMERAS.values(), samples, limit=LIMIT, window=0.5)
    return share, max(speaker.late for speaker in speakers)
