"""What robots of which little is known are presumed to send."""

from itertools import permutations

import pytest

from planner import Exponential, Step, Throughput
from planner.measures import Energy
from proxy.core.market.presumed import Presumed, untold
from proxy.core.market.standing import Row
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from proxy.core.protocol.messages import Digest, State, tag
from proxy.core.view.stream import Generated, Stream
from proxy.core.view.view import SharedView
from studies.simulation.traffic.flights import How, fly
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.missions import draw_from
from studies.simulation.traffic.scores import score
from studies.simulation.traffic.workloads import MBIT, Workload

AIR = broadcast("224.0.0.226:7449")
SMALL, LIMIT = 0.05, Limit("throughput", 0.5, 10_000.0, Throughput(20_000.0, 0.5), 1.0)
OWN = Limit("energy", 0.5, 10_000.0, Energy(1.0, 0.5, per_byte=1e-3), 1.0)


@pytest.fixture
def view(make_specs):
    return SharedView(CoreSettings("r1", "z-r1"), make_specs())


@pytest.fixture
def a_row(view):
    """Return a stream as it is weighed: it generated so many samples, so far apart; if many, its rate is known."""
    kind = view.specs.match("robot/r1/camera")

    def make(robot, count=0, interval=0.5, *, use=(100.0,), key="odometry"):
        stream = Stream(1, robot, key, kind)
        for number in range(1, count + 1):
            stream.note_generated(number, Generated(interval * number, 100, 1.0))
        return Row(stream, interval, 0.0, 1.0, use, (0.0,) * len(use))

    return make


def bidders(rows, *robots, limits=(LIMIT,), now=10.0):
    return Presumed("r1", limits, robots).bidders(now, rows, SMALL)


def test_each_has_our_small_streams(a_row):
    """What is larger goes in turn, or is contested: nobody knows that of others."""
    ours = [a_row("r1", 20), a_row("r1", 20, 0.1, key="pose"), a_row("r1", 20, key="c", use=(900.0,))]
    assert bidders(ours, "r2", "r3") == [*ours[:2], *ours[:2]]
    assert not bidders(ours)


def test_very_many_do_not_bid(a_row):
    """Two hundred robots that may have fifty streams each would take 67 ms to weigh."""
    ours = [a_row("r1", 20, key=f"{number}") for number in range(TUNING.bids // 10)]
    robots = [f"r{number}" for number in range(2, 13)]
    assert len(bidders(ours, *robots[:10])) == TUNING.bids
    assert not bidders(ours, *robots)


def test_what_is_known_of_a_robot_is_not_presumed_beside_that(a_row):
    """Half of what we have is known of it: the rest may come half as often."""
    rows = [a_row("r1", 20, 0.1), a_row("r2", 4, 0.2)]
    assert [row.interval for row in bidders(rows, "r2")] == [pytest.approx(0.2)]


@pytest.mark.parametrize(("small", "large", "presumed"), [(4, 0, True), (20, 0, False), (20, 4, False)])
def test_a_robot_of_which_each_small_stream_is_known_differs_from_us(a_row, small, large, presumed):
    """Three robots with equal streams whose rates differ by chance reached 88 % of a central decider, and 97 so."""
    rows = [a_row("r1", 20, 0.1), a_row("r2", small, 2.0)]
    if large:
        rows.append(a_row("r2", large, key="camera", use=(900.0,)))
    assert bool(bidders(rows, "r2", now=100.0)) is presumed


def test_others_use_nothing_of_a_limit_that_is_ours_alone(a_row):
    """Energy."""
    limits = LIMIT, OWN
    ours = a_row("r1", 20, use=(100.0, 50.0))
    assert [row.use for row in bidders([ours], "r2", limits=limits)] == [(100.0, 0.0)]
    assert Presumed("r1", limits, ["r2"]).lacking([ours], [0.5]) == (100.0, 0.0)


@pytest.mark.parametrize(("told", "reported", "amount"), [(9.9, None, 20.0), (9.0, None, 100.0), (9.0, 9.75, 50.0)])
def test_what_others_sent_since_they_told_is_untold(view, a_row, told, reported, amount):
    """A digest that says nothing of a stream says that it sent nothing; of a window no more counts than there is."""
    row = a_row("r2")
    row.stream.touch(told)
    view.add_peer(0.0, "r2", "z-r2")
    digest = Digest("r2", tag("z-r2"), reported or 9.9, partial=reported is None)
    view.staleness.heard(10.0, view.peers[tag("z-r2")], digest)
    assert untold(10.0, view, [(row, 0.5)], (LIMIT,)) == (pytest.approx(amount),)


@pytest.mark.parametrize("theirs", [UNICAST, AIR])
@pytest.mark.parametrize("ours", [UNICAST, AIR])
def test_nothing_is_presumed_of_a_robot_that_is_overheard(make_specs, a_row, ours, theirs):
    """What was not heard of its streams it dropped, and may have had no word left to say so."""
    view = SharedView(CoreSettings("r1", "z-r1", transport=ours), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    told = State("r2", "z-r2", "enforce", "", (), (), number=1, transport=theirs)
    view.heard_state(0.1, told)
    view.staleness.heard(1.0, view.peers[tag("z-r2")], Digest("r2", tag("z-r2"), 1.0, 0, 0))
    streams = [a_row("r1", 20).stream, a_row("r2", 3).stream]
    presumed = Presumed.of(60.0, view, streams, (LIMIT,))
    assert list(presumed.robots) == ([] if ours == theirs == AIR else ["r2"])


@pytest.mark.full
@pytest.mark.parametrize("before", [0.0, pytest.param(5.0, marks=pytest.mark.full)])
def test_a_team_that_could_not_tell_what_it_sends_keeps_the_limit(before):
    """Twelve robots with small samples alone, which may tell each other 1.3 kB/s: each knew of one or two streams.

    They filled windows to 1.9 limits. Where daemons begin some seconds earlier what they said then is not paid for yet.
    """
    kind = Kind("status", Step(1.0, 10.0), (4.5, 6.0), (900, 1_100))
    team = Workload("status", ((kind,),) * 12, 0.3 * MBIT, 2.5)
    mission, how = draw_from(team, 3, 15.0, latency=0.002), How(latency=0.002, loss=0.0, before=before)
    found = score(mission, fly(mission, how, 3), how.loss)
    assert found.over <= 0.02
    assert found.fill >= 0.5


def test_one_that_sends_among_many_that_only_listen_is_not_held_up_for_long():
    """They have few words to say so. The first robot alone has a stream, which takes a quarter of the limit."""
    kind = Kind("status", Exponential(1.0, 0.5), (30.0, 30.0), (1_000, 1_000))
    team = Workload("alone", ((kind,), *((),) * 11), MBIT, 0.5)
    mission, how = draw_from(team, 3, 14.0, latency=0.002), How(latency=0.002, loss=0.0, before=5.0)
    sent = [air.t for air in fly(mission, how, 3).on_air if air.frame is not None]
    assert sum(t < 10.0 for t in sent) >= 100
    assert sum(12.0 <= t < 14.0 for t in sent) >= 58


class Hashed(str):
    """A name that has the same place in a set in any process."""

    __slots__ = ("number",)

    def __hash__(self):
        return self.number


def test_what_robots_are_taken_to_send_is_the_same_in_any_process(view, a_row):
    """Names are in another order in a set there, and sums in another order differ: an exact replay would, too."""
    names = [Hashed(name) for name in ("r2", "r3", "r4")]
    found = set()
    for numbers in permutations(range(3)):
        for name, number in zip(names, numbers, strict=True):
            name.number = number
        uses = zip(("r1", *names), (2.0, 0.9, 0.8, 0.7), strict=True)
        rows = [a_row(robot, use=(use,)) for robot, use in uses]
        found.add(Presumed.of(9.0, view, [row.stream for row in rows], (LIMIT,)).lacking(rows, [0.5] * 4))
    assert len(found) == 1
