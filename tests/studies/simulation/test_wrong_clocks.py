"""Teams whose clocks drift, are wrong and are set: what they decide, and what they believe of each other."""

from dataclasses import replace

import numpy as np
import pytest

from planner import SearchSettings, start
from proxy.core import events as ev
from proxy.core.commands import Decide
from proxy.core.core import Core
from proxy.core.settings import CoreSettings
from studies.simulation.clocks import EPOCH, Clock, booted_without_time
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from utility_specs import load_specs

SPEC = """
[[constraint]]
kind = "throughput"
limit = "200 kB/s"
window = 0.95

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "most_recent"
weight = 1.0
utility = { kind = "video" }
"""
RATE = 400_000.0
SIZES = (500, 3_000, 12_000, 24_000)
END = 12.0
DRIFTING = {"r1": Clock(600.0, 100.0), "r2": Clock(-300.0, -100.0), "r3": Clock(20.0, 50.0)}
WRONG = {
    "ten seconds apart": {"r1": Clock(wall=10.0), "r2": Clock(wall=-10.0)},
    "set back by a minute": {"r1": Clock(steps=((6.0, -60.0),)), "r2": Clock(steps=((7.0, 60.0),))},
    "set by a little": {"r1": Clock(steps=((5.0, -3.0), (8.0, 0.3))), "r2": Clock(steps=((6.0, -0.1),))},
    "no time at boot": {"r1": booted_without_time(1e9), "r2": booted_without_time(7.0)},
}


@pytest.fixture(scope="module")
def fly(tmp_path_factory):
    """Let three robots that want each other's cameras fly over a medium."""
    path = tmp_path_factory.mktemp("fly") / "spec.toml"
    path.write_text(SPEC)
    specs = load_specs(path)

    def fly_with(clocks, coordination="shares", **medium):
        interests = {f"r{r}": ("robot/*/camera",) for r in (1, 2, 3)}
        best = SearchSettings(search="best")
        flight = Recorded(
            specs,
            interests,
            Medium(RATE, **medium),
            search=best,
            iterations=100,
            clocks=clocks,
            settings=CoreSettings("", "", coordination=coordination),
        )
        flight.run(frames(), END)
        return flight

    return fly_with


def frames():
    """Seven a second of each robot, of sizes from 500 B to 24 kB."""
    rng = np.random.default_rng(1)
    return sorted(
        (
            Frame(f"r{r}", f"robot/r{r}/camera", 1.0 + 0.023 * r + k / 7.0, int(rng.choice(SIZES)), {})
            for r in (1, 2, 3)
            for k in range(int(7 * END) - 10)
        ),
        key=lambda frame: frame.t_gen,
    )


@pytest.fixture(scope="module")
def right(fly):
    """A flight with right clocks, in which all streams of all robots are part of every decision."""
    return fly({}, coordination="overhear")


@pytest.fixture(scope="module")
def drifting(fly):
    """One with clocks that drift."""
    return fly(DRIFTING, coordination="overhear")


@pytest.fixture(scope="module")
def losing(fly):
    """One where digests and samples are late or lost, too."""
    return fly(DRIFTING, coordination="overhear", jitter=0.01, loss=0.2)


@pytest.fixture(scope="module")
def stepping(fly):
    """One with wall clocks that are set by a little."""
    return fly(WRONG["set by a little"], coordination="overhear")


class Recorded(Team):
    """A team that keeps what happened to each robot."""

    def __post_init__(self):
        self.events = {robot: [] for robot in self.interests}
        super().__post_init__()

    def _feed(self, member, t, event):
        self.events[member.robot].append((t, event))
        super()._feed(member, t, event)


def believed(flight):
    """Each robot, and each peer of it with the member that it stands for."""
    members = flight.members
    return [(members[r], members[p.robot], p) for r in members for p in members[r].core.view.peers.values()]


def taken(flight, sender, receiver, size):
    """What samples of a size took once robots knew each other [s], in the middle."""
    return np.median(
        [
            d.t_rcv - d.t_sent
            for d in flight.deliveries
            if (d.frame.robot, d.receiver, d.frame.size) == (sender.robot, receiver.robot, size)
            and d.t_rcv is not None
            and d.t_sent > END / 3
        ]
    )


@pytest.mark.parametrize("clocks", WRONG.values(), ids=WRONG)
def test_wrong_wall_clocks_alter_no_decision(right, clocks):
    """All that a robot lives through, with wall clocks that are wrong: 99 of 100 decisions are the same.

    Each is compared by itself; the robot lives on with what was decided with right clocks. Where a clock is set by so
    little that its samples still seem to be possible, they spoil latencies until that is told.
    """
    same = [verdict for robot in right.interests for verdict in decided_again(right, robot, clocks)]
    assert len(same) > 100
    print(f"{np.mean(same):.2%} of {len(same)} decisions are the same")
    assert np.mean(same) >= (0.97 if clocks is WRONG["set by a little"] else 0.99)


def decided_again(flight, robot, clocks):
    """Whether a robot decides each sample of a flight as it did, if wall clocks are those."""
    own = clocks.get(robot, Clock())
    settings = replace(flight.members[robot].core.settings, wall_offset=wall_offset(clocks, robot, 0.0))
    core, asked, same = Core(settings, flight.specs, own.monotonic(0.0)), [], []
    for event in told_wrongly(flight.events[robot], robot, clocks):
        happens = event
        if isinstance(event, ev.DecisionReady):
            decide = asked.pop()
            same.append(plan(flight, decide, seed=event.ticket).send == event.plan.send)
            happens = replace(event, ticket=decide.ticket)
        asked += [command for command in core.handle(happens) if isinstance(command, Decide)]
    return same


def plan(flight, decide, seed):
    search = start(decide.problem, flight.search, seed)
    search.run(decide.iterations)
    return search.plan()


def told_wrongly(events, robot, clocks):
    """What happens to a robot if wall clocks are those: timestamps, states, and the steps that are noticed."""
    states, looked = {}, 0.0
    for t, event in events:
        if t >= looked + 1.0:
            looked = t
            yield ev.ClockChanged(event.now, wall_offset(clocks, robot, t))
            for name, state in states.items():
                yield ev.StateHeard(event.now, replace(state, wall_offset=wall_offset(clocks, name, t - 0.1)))
        if isinstance(event, ev.SampleHeard):
            clock = clocks.get(event.origin.removeprefix("z-"), Clock())
            yield replace(event, stamp=clock.wall_time(event.stamp - EPOCH))
        elif isinstance(event, ev.StateHeard):
            states[event.state.robot] = event.state
            told = wall_offset(clocks, event.state.robot, looked)
            yield replace(event, state=replace(event.state, wall_offset=told))
        else:
            yield event


def wall_offset(clocks, robot, t):
    """What the wall clock of a robot shows more than its monotonic clock at true time `t`."""
    clock = clocks.get(robot, Clock())
    return clock.wall_time(t) - clock.monotonic(t)


@pytest.mark.parametrize("flown", ["drifting", "losing"])
def test_offsets_are_right_within_what_they_claim(request, flown):
    """However clocks drift, and with digests that are late or lost."""
    flight = request.getfixturevalue(flown)
    for member, other, peer in believed(flight):
        error = abs(peer.offset.offset - (member.now(END) - other.now(END)))
        assert error <= peer.offset.uncertainty(member.now(END))
        assert error <= 0.01


@pytest.mark.parametrize("flown", ["drifting", "stepping"])
def test_latencies_are_right_by_size_on_both_ends(request, flown):
    """As the receiver finds, as the sender is told, and as the third robot overhears."""
    flight = request.getfixturevalue(flown)
    for receiver, sender, peer in believed(flight):
        told = sender.core.view.peers[f"z-{receiver.robot}"]
        (third,) = (m for m in flight.members.values() if m not in (receiver, sender))
        overheard = third.core.view.peers[f"z-{sender.robot}"].heard_by[f"z-{receiver.robot}"]
        for size in SIZES[1:3]:
            truth = taken(flight, sender, receiver, size)
            assert peer.line_in.of(size) == pytest.approx(truth, abs=0.015)
            assert told.line_out.of(size) == pytest.approx(truth, abs=0.015)
            assert overheard.of(size) == pytest.approx(truth, abs=0.015)


def test_losses_are_found_on_both_ends(losing):
    """Of every way by itself."""
    for receiver, sender, peer in believed(losing):
        ways = [d for d in losing.deliveries if (d.frame.robot, d.receiver) == (sender.robot, receiver.robot)]
        truth = np.mean([d.t_rcv is None for d in ways])
        told = sender.core.view.peers[f"z-{receiver.robot}"]
        assert peer.loss_in == pytest.approx(truth, abs=0.08)
        assert told.loss_out == pytest.approx(truth, abs=0.08)
