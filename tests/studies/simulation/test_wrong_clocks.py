"""Teams whose clocks drift, are wrong and are set: what they decide, and what they believe of each other."""

import numpy as np
import pytest

from planner import SearchSettings
from proxy.core.model.settings import CoreSettings
from studies.simulation.clocks import Clock, booted_without_time
from studies.simulation.medium import Medium
from studies.simulation.records import Frame
from studies.simulation.replay import Recorded, decided_alike
from utility_specs import load_specs

pytestmark = pytest.mark.full

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

    def fly_with(clocks, coordination="announce", rate=RATE, **medium):
        interests = {f"r{r}": ("robot/*/camera",) for r in (1, 2, 3)}
        best = SearchSettings(search="best")
        flight = Recorded(
            specs,
            interests,
            Medium(rate, **medium),
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
    return fly({})


@pytest.fixture(scope="module")
def drifting(fly):
    """One with clocks that drift."""
    return fly(DRIFTING)


@pytest.fixture(scope="module")
def quick(fly):
    """One on a channel so fast that no sample waits at its robot until others are carried: all take as long as ever."""
    return fly(DRIFTING, rate=6.0 * RATE)


@pytest.fixture(scope="module")
def losing(fly):
    """One where digests and samples are late or lost, too."""
    return fly(DRIFTING, jitter=0.01, loss=0.2)


@pytest.fixture(scope="module")
def stepping(fly):
    """One with wall clocks that are set by a little."""
    return fly(WRONG["set by a little"])


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


def test_wrong_wall_clocks_alter_no_decision(right):
    """All that a robot lives through, with wall clocks that are wrong: 99 of 100 decisions are the same.

    Each is compared by itself; the robot lives on with what was decided with right clocks. What tells of a clock that
    was set takes room of its own: of two plans that are worth the same the other one may be the better one then.
    """
    same = {name: decided_alike(right, clocks, END) for name, clocks in WRONG.items()}
    assert min(map(len, same.values())) > 100
    assert np.mean([alike for each in same.values() for alike in each]) >= 0.99
    assert min(map(np.mean, same.values())) >= 0.98


@pytest.mark.parametrize("flown", ["drifting", pytest.param("losing", marks=pytest.mark.full)])
def test_offsets_are_right_within_what_they_claim(request, flown):
    """However clocks drift, and with digests that are late or lost."""
    flight = request.getfixturevalue(flown)
    for member, other, peer in believed(flight):
        error = abs(peer.offset.offset - (member.now(END) - other.now(END)))
        assert error <= peer.offset.uncertainty(member.now(END))
        assert error <= 0.01


@pytest.mark.parametrize("flown", ["quick", pytest.param("stepping", marks=pytest.mark.full)])
def test_latencies_are_right_by_size_on_both_ends(request, flown):
    """As the receiver finds, as the sender is told, and as the third robot overhears."""
    flight = request.getfixturevalue(flown)
    for receiver, sender, peer in believed(flight):
        told = sender.core.view.peers[f"z-{receiver.robot}"]
        (third,) = (m for m in flight.members.values() if m not in (receiver, sender))
        overheard = third.core.view.peers[f"z-{sender.robot}"].heard_by[f"z-{receiver.robot}"]
        for size in SIZES[1:3]:
            truth = taken(flight, sender, receiver, size)
            assert peer.inbound.line.of(size) == pytest.approx(truth, abs=0.015)
            assert told.outbound.line.of(size) == pytest.approx(truth, abs=0.02)  # as it was when it was told
            assert overheard.of(size) == pytest.approx(truth, abs=0.02)


def test_losses_are_found_on_both_ends(losing):
    """Of every way by itself."""
    for receiver, sender, peer in believed(losing):
        ways = [d for d in losing.deliveries if (d.frame.robot, d.receiver) == (sender.robot, receiver.robot)]
        told = sender.core.view.peers[f"z-{receiver.robot}"]
        for found, counts in (
            (peer.inbound.losses.share, peer.inbound.losses._read),
            (told.outbound.losses.share, told.outbound.losses._read),
        ):
            told_of = counts[-1][0] - counts[0][0]  # from the first news on, which came after a few samples
            assert told_of > len(ways) / 2
            lost = [d.t_rcv is None for d in ways]
            shares = [np.mean(lost[first : first + told_of]) for first in range(len(ways) - told_of + 1)]
            assert min(abs(found - share) for share in shares) < 1.5 / told_of  # one may be under way
