"""The benchmark of real daemons tells what they did with what was published."""

import os
import socket
import struct
import threading
import time
from dataclasses import replace

import pytest

from studies.benchmarks.traffic import drawn as drawn_daemons
from studies.benchmarks.traffic.__main__ import main
from studies.benchmarks.traffic.agenda import draw
from studies.benchmarks.traffic.between import Way, listen
from studies.benchmarks.traffic.figures import best, figures, reached
from studies.benchmarks.traffic.flight import Flight, Published
from studies.benchmarks.traffic.measure import CASES, Case
from studies.benchmarks.traffic.payload import HEAD, Label, payload, read
from studies.simulation.traffic.drawn import drawn_by
from tests.waiting import wait_until

ALARM = [kind.name for kind in Case().workload.kinds].index("alarm")
ODOMETRY = [kind.name for kind in Case().workload.kinds].index("odometry")
CAMERA = [kind.name for kind in Case().workload.kinds].index("camera")


def test_real_daemons_carry_real_traffic(measured):
    """Of one robot and of two all is counted; of one nearly all small samples arrive, and each alarm."""
    got, took, where = measured("daemons")
    assert [row[0] for row in got.rows] == [row[0] for row in took.rows] == [case.name for case in CASES[:2]]
    for _, utility, others, gap, filled, small, *_, alarms, _, _, fullest in got.rows:
        assert 30.0 < float(utility.rstrip("%")) <= 100.5 + float(gap.rstrip("%"))
        assert float(others.rstrip("%")) > 20.0
        assert 5 <= int(filled.rstrip("%")) <= 120
        assert float(small.rstrip("%")) > 25.0
        arrived, published = map(int, alarms.split("/"))
        assert 0 <= arrived <= published
        assert 10 <= int(fullest.rstrip("%")) <= 250
    small, alarms = got.rows[0][5], got.rows[0][-4]
    assert float(small.rstrip("%")) > 80.0
    assert len(set(alarms.split("/"))) == 1  # all that were published arrived
    for _, digests, framing, robot, operator, *_ in took.rows:
        assert int(digests) > 0
        assert int(framing) > 0
        assert float(robot) > 0.0
        assert float(operator) > 0.0
    assert [row[0] for row in where.rows] == [case.name for case in CASES[:2]]
    for *_, whole in where.rows:
        assert float(whole) > 0.0


def test_with_one_seed_the_same_is_published():
    """And without some kinds, the same of all others."""
    workload = Case(robots=2).workload
    all_of_it, again = draw(workload, 10.0, 7), draw(workload, 10.0, 7)
    without = draw(workload, 10.0, 7, ("camera",))
    assert all_of_it == again != draw(workload, 10.0, 8)
    for robot, fewer in zip(all_of_it.robots, without.robots, strict=True):
        assert fewer == tuple(sample for sample in robot if sample[1] != CAMERA)


def test_a_case_has_its_limit_and_its_frames():
    """All else is as in *mixed*."""
    workload = Case(robots=3, limit=3e6, frame=8_000).workload
    assert len(workload.robots) == 3
    assert workload.rate == 375_000.0
    assert {kind.sizes for kind in workload.kinds if kind.name == "camera"} == {(8_000, 8_000)}
    assert workload.kinds[ODOMETRY] == Case().workload.kinds[ODOMETRY]


def test_a_payload_tells_which_sample_it_is():
    """Whatever stands before it; one too small for that is refused."""
    label = Label(3, 1, 70_000, 76, 12.5)
    assert len(payload(label)) == 76
    assert read(b"before" + payload(label), 6) == label
    with pytest.raises(ValueError, match="no room for its label"):
        payload(replace(label, size=HEAD - 1))


def test_a_way_tells_samples_from_what_daemons_tell_each_other():
    """Of a sample in pieces the first one tells when it crossed, however the others are mixed with small ones."""
    way = Way("r1", "operator")
    large, small = payload(Label(0, CAMERA, 4, 300, 1.0)), payload(Label(0, ODOMETRY, 9, 100, 1.1))
    batches = [
        batch(FRAGMENT, large[:150]),
        batch(FRAME, small),
        batch(FRAGMENT, large[150:]),
        batch(FRAME, b"a digest"),
        batch(KEEP_ALIVE, b""),
        batch(FRAGMENT, b"a long state"),
    ]
    crossings = [way.crossing(float(at), each) for at, each in enumerate(batches)]
    assert [crossing[:4] for crossing in crossings] == [[at, "r1", "operator", len(b)] for at, b in enumerate(batches)]
    assert [crossing[4] for crossing in crossings] == [0, 0, 0, len(batches[3]), 0, len(batches[5])]
    assert [crossing[5] for crossing in crossings] == [[(0, CAMERA, 4, 300)], [(0, ODOMETRY, 9, 100)], [], [], [], []]


def test_links_carry_every_byte_and_note_when_it_came():
    """Both ways, once the robot that is dialled listens."""
    crossed, stop = [], threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as robot:
        port = listen("a", "b", robot.getsockname()[1], crossed, stop)
        with socket.create_connection(("127.0.0.1", port)) as near, robot.accept()[0] as far:
            there, back = batch(FRAME, payload(Label(0, 0, 1, 200, 0.0))), batch(FRAME, b"well")
            before = time.monotonic()
            near.sendall(there)
            assert far.recv(len(there), socket.MSG_WAITALL) == there
            far.sendall(back)
            assert near.recv(len(back), socket.MSG_WAITALL) == back
            wait_until(lambda: len(crossed) == 2, what="the note of what came back")
            after = time.monotonic()
    stop.set()
    crossed.sort()  # each way notes what it carried after it did
    assert [(source, sink, told) for _, source, sink, _, told, _ in crossed] == [("a", "b", 0), ("b", "a", len(back))]
    assert before - 0.01 < crossed[0][0] <= crossed[1][0] < after + 0.01


def test_figures_are_of_what_arrived_after_the_warm_up():
    """Shares and ages by kind, bytes as they crossed, windows of all that was sent, digests too."""
    workload = Case(robots=1).workload
    found = figures(flight(), workload)
    assert (found.small.published, found.small.arrived) == (3, 2)
    assert found.small.p50 == pytest.approx(0.03)
    assert found.kinds["alarm"].share == 1.0
    assert found.kinds["camera"].share == 0.5
    assert found.sent == 26_000 + 116 + 76
    assert found.told == 40 / 7.0
    assert found.framing == pytest.approx((20 + 20 + 20) / 7.0)
    assert found.over == 0.0
    assert found.worst == pytest.approx((26_000 + 40 + 116 + 76) / 62_500)
    assert found.processor == pytest.approx({"r1": 0.1, "operator": 0.1})
    assert found.late == pytest.approx(0.001)


def test_a_window_over_the_limit_is_found():
    """It holds what was sent half a second before a send, itself included."""
    crossed = [(t, "r1", "operator", 26_020, 0, [(0, CAMERA, n, 26_000)]) for n, t in enumerate((4.0, 4.2, 4.4, 6.0))]
    found = figures(replace(flight(), crossed=crossed), Case(robots=1).workload)
    assert found.over == 0.25
    assert found.worst == pytest.approx(78_000 / 62_500)
    assert found.sustained == pytest.approx(104_000 / 1_250_000)


def test_the_best_plan_is_worth_more_than_what_arrived():
    """It sends what was lost, and what was sent at once."""
    workload = Case(robots=1).workload
    could, was = best(flight(), workload, 10.0), reached(flight(), workload)
    assert could.gap == pytest.approx(0.0, abs=1e-4)
    assert could.size == 26_000 + 26_000 + 2 * 116 + 76
    assert could.worth.everything > was.everything > was.others
    assert could.worth.everything - could.worth.others == pytest.approx(20.0 * 5.98)
    assert was.everything - was.others == pytest.approx(20.0 * 5.96)


def test_the_command_refuses_what_it_does_not_know(capsys):
    """And says what it knows."""
    with pytest.raises(SystemExit):
        main(["--robot", "two"])
    assert "--robots" in capsys.readouterr().err


def flight():
    """One robot for ten seconds: one sample of odometry and one frame get lost, two come before the warm-up ends."""
    times = {
        (0, ODOMETRY, 0): 1.0,
        (0, CAMERA, 0): 2.0,
        (0, CAMERA, 1): 4.0,
        (0, ODOMETRY, 1): 4.1,
        (0, ALARM, 0): 4.02,
        (0, ODOMETRY, 2): 5.0,
        (0, CAMERA, 2): 8.0,
    }
    sizes = {ODOMETRY: 116, CAMERA: 26_000, ALARM: 76}
    published = {name: Published(sizes[name[1]], t - 0.001, t) for name, t in times.items()}
    lost = {(0, ODOMETRY, 2), (0, CAMERA, 2)}
    received = {name: t + (0.04 if name[1] == ODOMETRY else 0.02) for name, t in times.items() if name not in lost}
    crossed = [
        (t + 0.01, "r1", "operator", sizes[name[1]] + 20, 0, [(*name, sizes[name[1]])])
        for name, t in times.items()
        if name not in lost
    ]
    crossed.append((4.015, "r1", "operator", 40, 40, []))
    ordered = sorted(crossed, key=lambda crossing: crossing[0])
    return Flight(10.0, published, received, ordered, {"r1": 0.7, "operator": 0.5}, {}, None, os.getloadavg()[:2])


def batch(kind, body):
    """A batch as links carry it, its length in front."""
    return struct.pack("<HB", len(body) + 1, kind) + body


KEEP_ALIVE, FRAME, FRAGMENT = 0x04, 0x05, 0x06


@pytest.mark.full
def test_real_daemons_fly_what_is_drawn(tmp_path, capsys):
    """The page has a row for each workload, with what was reached of the best."""
    page, drawn = tmp_path / "drawn_daemons.md", drawn_by(81)
    arguments = ["--first", "80", "--seeds", "2", "--robots", "2", "--seconds", "8", "--time-limit", "5"]
    assert drawn_daemons.main([*arguments, "--output", str(page)]) == 0
    out, err = capsys.readouterr()
    (flown,) = err.splitlines()
    assert flown.startswith(f"workload {drawn.offer}; utility of the best ")
    reached_of_best = float(flown.split("utility of the best ")[1].split("%")[0])
    assert 20.0 < reached_of_best <= 105.0
    assert drawn.offer in page.read_text()
    assert drawn.offer in out
    assert out.splitlines()[-1].startswith("1 flights, ")


@pytest.mark.full
def test_real_daemons_fly_unequal_teams(tmp_path, capsys):
    """Some robots have nothing to publish, and some streams pause; the page says how to fly the same again."""
    page, (drawn,) = tmp_path / "drawn_daemons.md", drawn_daemons.drawn_for([UNEQUAL], 12, unequal=True)
    assert () in drawn.workload.robots
    arguments = ["--first", str(UNEQUAL), "--seeds", "1", "--seconds", "8", "--time-limit", "5", "--unequal"]
    assert drawn_daemons.main([*arguments, "--output", str(page)]) == 0
    assert drawn.offer in capsys.readouterr().out
    assert f"--first {UNEQUAL} --seeds 1 --robots 12 --seconds 8 --time-limit 5 --unequal" in page.read_text()


UNEQUAL = 81
"""Draws an unequal team of two robots, the first of which has nothing."""


def test_what_is_drawn_has_to_be_disputed_and_small(capsys):
    """Else nothing is flown, and the command says so."""
    with pytest.raises(SystemExit):
        drawn_daemons.main(["--first", "80", "--seeds", "1"])
    assert "something to dispute" in capsys.readouterr().err
    few = drawn_daemons.drawn_for(range(40), 3, unequal=True)
    assert few
    assert all(drawn.disputed and len(drawn.workload.robots) <= 3 for drawn in few)
    assert set(few) < set(drawn_daemons.drawn_for(range(40), 12, unequal=True))


def test_the_last_line_tells_the_worst_of_all_flights():
    """And the median of what was reached."""
    workload, drawn = Case(robots=1).workload, drawn_by(81)
    of, could = figures(flight(), workload), best(flight(), workload, 10.0)
    parts = (could.worth, replace(could.worth, everything=0.5 * could.worth.everything))
    found = [drawn_daemons.Result(drawn, of, worth, could) for worth in parts]
    expected = (
        f"2 flights, 75.0% of the best plan (50.0% at least), 0.0% of windows over, fullest 10 s {of.sustained:.0%}"
    )
    assert drawn_daemons.last_line(found) == expected
