"""What decisions on a real network are worth: real daemons, links that lose packets, and the offline optimum."""

import pytest

from tests.system.flight import Camera, utility_share
from tests.waiting import wait_until

pytestmark = pytest.mark.system

CAMERAS = {name: Camera(f"robot/{name}/camera", size, 10) for name, size in (("a", 6000), ("b", 8000), ("c", 10_000))}
"""They publish 1.9 Mbit/s together."""
LIMIT = 800_000
SECONDS = 12.0


@pytest.mark.parametrize(
    ("transport", "loss", "least"),
    [("unicast", 0, 0.75), ("broadcast", 0, 0.8), ("unicast", 10, 0.65), ("broadcast", 10, 0.6)],
)
def test_a_flight_is_worth_most_of_what_it_could_be(team, transport, loss, least):
    """Whoever decides alone, on links that lose packets, the operator gets most of what the best plan gives."""
    robots = team("abcd", limit="800 kbit/s", mesh=f'transport = "{transport}"')
    operator = robots[-1]
    for robot in robots:
        robot.host.lose(loss)
    heard = operator.hear("robot/*/camera")
    speakers = [
        robot.say(camera.key, size=camera.size, rate=camera.rate)
        for robot, camera in zip(robots, CAMERAS.values(), strict=False)
    ]
    wait_until(lambda: len({s["key"] for s in heard.heard()}) == 3, what="samples of all")
    begun = heard.heard()[-1]["heard"] + 3.0
    wait_until(lambda: heard.heard()[-1]["heard"] >= begun + SECONDS, 3 * SECONDS, "the end of the flight")
    for speaker in speakers:
        speaker.stop()
    share = utility_share(CAMERAS.values(), [s for s in heard.heard() if s["heard"] >= begun], limit=LIMIT, window=0.5)
    print(f"{transport}, {loss} % of packets lost: {share:.1%} of the offline optimum")
    assert share >= least
