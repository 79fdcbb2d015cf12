"""What leaves for the mesh: paced, bounded, never lost without a word."""

import itertools
import threading
from dataclasses import replace

import pytest
import zenoh
from zenoh import shm

from proxy.bridge import egress as egress_module
from proxy.bridge.demand import Demand
from proxy.bridge.egress import Egress
from proxy.bridge.keys import kept
from proxy.bridge.passed import FULL, Passed
from proxy.bridge.room import rooms
from proxy.bridge.sample import Held, Parcel
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.sessions import mesh_options, open_session
from proxy.bridge.tuning import TUNING
from proxy.core.interface.events import CopyHanded, SampleHanded, SampleRefused
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until

LARGE = "x" * 200_000
"""More than a link surely takes at once."""


class Bench:
    """An egress onto a session that a peer listens to, and samples to send."""

    def __init__(self, stack, rate=None, most=8192, most_bytes=1 << 24):
        endpoint = free_endpoint()
        options = mesh_options([endpoint], [], scouting=False, interface="auto", zenoh_options={})
        self.mesh = closing(stack, open_session(options, "mesh"))
        self.peer = closing(stack, plain_session("peer", connect=(endpoint,)))
        self.heard = Heard(self.peer, "**")
        self.posted = []
        self.rooms = rooms(most, most_bytes)
        self.passed = Passed()
        demand = Demand(self.mesh, lambda _: None, lambda: None)
        self.egress = Egress(self.mesh, demand, self.passed, self.posted.append, rate, rooms=self.rooms)
        stack.callback(self.egress.close, 1.0)
        publisher = self.mesh.declare_publisher("probe")
        wait_until(lambda: publisher.matching_status.matching, what="the peer's subscription")
        publisher.undeclare()
        self.egress.buffers.refresh()
        self._samples = Heard(self.mesh, "made")
        self._numbers = itertools.count()

    def held(self, payload, **quality):
        """A sample as ingress holds it."""
        before = len(self._samples.samples)
        self.mesh.put("made", payload, **quality)
        wait_until(lambda: len(self._samples.samples) > before, what="the sample")
        sample = self._samples.samples[-1]
        return Held(sample, self.mesh.new_timestamp(), "made", len(sample.payload), sample.source_info)

    def forward(self, number, held):
        """As ingress and core do: a covered sample has its place."""
        assert self.rooms.covered.enter(held.size)
        self.egress.forward(number, held)

    def fill(self):
        """From now on no link has room."""
        links = FullLinks()
        self.egress.buffers = self.egress.writer._buffers = links
        return links

    def mine(self):
        """What the peer heard from the egress: its samples are stamped."""
        return [s.payload.to_string() for s in self.heard.samples if s.timestamp is not None]


@pytest.fixture
def bench(stack):
    return Bench(stack)


def test_forwarded_samples_are_reported_when_handed_over(bench):
    """Each sample reaches the mesh and is answered with its number, in order."""
    for i in range(5):
        bench.forward(i, bench.held(str(i)))
    assert bench.egress.waiting["decided"] == 5
    bench.egress.start()
    wait_until(lambda: len(bench.posted) == 5, what="five answers")
    assert [(type(event), event.sample) for event in bench.posted] == [(SampleHanded, i) for i in range(5)]
    wait_until(lambda: len(bench.mine()) == 5, what="five samples")
    assert bench.egress.waiting == {"decided": 0, "passing": 0}


def test_what_need_not_wait_is_sent_by_whoever_brings_it(bench):
    """It takes no thread while links surely take it and nothing waits; else it has its turn."""
    held = bench.held("x")
    bench.egress.start()
    bench.forward(0, held)
    assert [event.sample for event in bench.posted] == [0]
    bench.fill()
    bench.forward(1, held)
    wait_until(lambda: [event.sample for event in bench.posted] == [0, 1], what="the one for which links have no room")


def test_a_copy_goes_to_one_robot_alone(bench):
    """On a key of its own, as it is otherwise, and is answered with whom it was for."""
    copies = Heard(bench.peer, kept("ab12cd34", "**"))
    wait_matching(bench.mesh, kept("ab12cd34", "made"))
    bench.egress.forward(7, bench.held("missed", attachment="of old")._replace(to="ab12cd34"))
    bench.egress.start()
    wait_until(lambda: bench.posted, what="the answer")
    wait_until(lambda: copies.samples, what="the copy")
    (copy,) = copies.samples
    assert (str(copy.key_expr), copy.attachment.to_string()) == (kept("ab12cd34", "made"), "of old")
    (answer,) = bench.posted
    assert (type(answer), answer.sample, answer.to) == (CopyHanded, 7, "ab12cd34")
    assert bench.mine() == []


def test_decided_samples_are_paced_while_links_are_busy(stack):
    """At 1 B/s one of three samples of 1 kB goes; when what went has left all of them do."""
    bench = Bench(stack, 1.0)
    busy = bench.fill()
    for i in range(3):
        bench.forward(i, bench.held("x" * 1000))
    passing = bench.held("urgent")._replace(key="urgent")
    bench.egress.start()
    wait_until(lambda: len(bench.posted) == 1, what="the first")
    bench.egress.pass_on("passed:no-spec", passing)
    wait_until(lambda: "urgent" in bench.mine(), what="what needs no pace")
    assert len(bench.posted) == 1
    busy.idle = True
    wait_until(lambda: len(bench.posted) == 3, what="the others")
    assert [event.sample for event in bench.posted] == [0, 1, 2]


def test_a_small_sample_does_not_wait_for_large_ones(stack):
    """Odometry goes at once, whatever frames wait for their pace before it; it is answered like all others."""
    bench = Bench(stack, 1000.0)
    bench.fill()
    frame = bench.held("x" * 90_000)
    for i in range(3):
        bench.forward(i, frame)
    bench.forward(3, bench.held("odometry")._replace(key="another"))
    bench.egress.start()
    wait_until(lambda: any(event.sample == 3 for event in bench.posted), what="the answer for the small sample")
    assert [event.sample for event in bench.posted][:2] in ([3], [3, 0])
    assert bench.egress.waiting["decided"] >= 2


def test_passing_samples_do_not_wait_for_paced_ones(stack):
    """What needs no decision overtakes what waits for its pace, and is counted with its bytes."""
    bench = Bench(stack, 1.0)
    bench.fill()
    for i in range(3):
        bench.forward(i, bench.held("x" * 1000))
    passing = bench.held("urgent")._replace(key="urgent")
    bench.egress.start()
    wait_until(lambda: len(bench.posted) == 1, what="the first")
    bench.egress.pass_on("passed:no-spec", passing)
    wait_until(lambda: "urgent" in bench.mine(), what="the passing sample")
    assert len(bench.posted) == 1
    reports = []
    wait_until(lambda: reports.extend(bench.passed.take(0.0)) or reports, what="its count")
    (report,) = reports
    assert (report.reason, report.count, report.size) == ("passed:no-spec", 1, 6)


def test_samples_of_a_key_stay_in_order_whichever_way_they_go(bench):
    """In shadow what was decided against passes, and a deletion passes, too: neither overtakes, nor is overtaken."""
    bench.fill()
    for i in range(6):
        held = bench.held(str(i))
        if i % 2:
            bench.forward(i, held)
        else:
            bench.egress.pass_on("passed:shadow", held)
    bench.egress.start()
    wait_until(lambda: len(bench.mine()) == 6, what="all of them")
    assert bench.mine() == [str(i) for i in range(6)]
    bench.forward(6, bench.held("6"))
    bench.egress.pass_on("passed:shadow", bench.held("7"))
    wait_until(lambda: len(bench.mine()) == 8, what="the last")
    assert bench.mine()[6:] == ["6", "7"]
    wait_until(lambda: bench.rooms.describe()["passing"]["samples"] == 0, what="room")
    assert bench.egress.waiting == {"decided": 0, "passing": 0}
    assert not bench.egress._deciding_keys
    assert not bench.egress._passing_keys


def test_passing_traffic_does_not_starve_decided_samples(stack):
    """However much passes, a decided sample is pushed back by a bounded time only."""
    bench = Bench(stack, 1000.0)
    bench.fill()
    for _ in range(20):
        bench.egress.pass_on("passed:no-spec", bench.held("x" * 1000))
    bench.forward(1, bench.held("decided"))
    bench.egress.start()
    wait_until(lambda: bench.posted, timeout=10.0, what="the decided sample, not 20 s later")


@pytest.mark.parametrize(("most", "most_bytes"), [(2, 1 << 24), (100, 400_000)])
def test_what_passes_finds_a_place_up_to_a_bound(stack, most, most_bytes):
    """Of samples or bytes; what finds none is counted."""
    bench = Bench(stack, most=most, most_bytes=most_bytes)
    held = bench.held(LARGE, congestion_control=zenoh.CongestionControl.BLOCK)
    for _ in range(3):
        bench.egress.pass_on("passed:no-spec", held)
    assert bench.rooms.passing.describe() == {"samples": 2, "bytes": 2 * len(LARGE)}
    assert [(r.reason, r.count, r.size) for r in bench.passed.take(0.0)] == [("dropped:full", 1, 0)]
    bench.egress.start()
    wait_until(lambda: bench.mine() == [LARGE] * 2, what="the others")
    assert bench.rooms.passing.describe() == {"samples": 0, "bytes": 0}


@pytest.mark.parametrize("decided", [True, False])
def test_a_sample_of_any_size_finds_a_place(stack, decided):
    """However little may wait: another one may wait beside it."""
    bench = Bench(stack, most_bytes=1000)
    wait = {"congestion_control": zenoh.CongestionControl.BLOCK}
    for held in (bench.held(LARGE, **wait), bench.held("small", **wait)):
        if decided:
            bench.forward(1, held)
        else:
            bench.egress.pass_on("passed:no-spec", held)
    bench.egress.start()
    wait_until(lambda: bench.mine() == [LARGE, "small"], what="both")


def test_decided_samples_keep_their_place_until_they_are_sent(bench):
    """Also where none is sent any more."""
    bench.forward(1, bench.held("first"))
    assert bench.rooms.covered.samples == 1
    bench.egress.start()
    wait_until(lambda: bench.rooms.covered.samples == 0, what="the first to leave")
    bench.egress.close(1.0)
    bench.forward(2, bench.held("second"))
    assert bench.rooms.covered.samples == 0


def test_what_passes_is_sent_by_whoever_brings_it(bench):
    """While the links take it no thread is needed; behind what waits it waits its turn."""
    bench.egress.pass_on("passed:no-spec", bench.held("first"))
    wait_until(lambda: bench.mine() == ["first"], what="the sample")
    for payload in (LARGE, "last"):
        bench.egress.pass_on("passed:no-spec", bench.held(payload, congestion_control=zenoh.CongestionControl.BLOCK))
    assert bench.egress.waiting["passing"] == 2
    bench.egress.start()
    wait_until(lambda: bench.mine() == ["first", LARGE, "last"], what="all of them, in order")


def test_whoever_brings_more_than_the_thread_can_send_lets_it_catch_up(bench, monkeypatch):
    """The wait is bounded where the thread does not come, and ends when little waits any more."""
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, passing_backlog=1))
    large = bench.held(LARGE, congestion_control=zenoh.CongestionControl.BLOCK)
    for _ in range(2):
        bench.egress.pass_on("passed:no-spec", large)
    assert bench.egress.waiting["passing"] == 2
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, passing_backlog=1, catch_up=60.0))
    bench.egress.start()
    bench.egress.pass_on("passed:no-spec", large)
    wait_until(lambda: len(bench.mine()) == 3, what="all three")


def test_what_passed_without_the_thread_comes_before_what_needs_it_and_after_it(bench):
    """Samples of one publisher keep their order however often the thread takes over and gives back."""
    wait = {"congestion_control": zenoh.CongestionControl.BLOCK}
    small = [bench.held(str(i), **wait) for i in range(60)]
    large = bench.held(LARGE, **wait)
    bench.egress.start()
    for i, held in enumerate(small):
        bench.egress.pass_on("passed:no-spec", held)
        if i % 20 == 0:
            bench.egress.pass_on("passed:no-spec", large)
    wait_until(lambda: len(bench.mine()) == 63, what="all of them")
    assert [payload for payload in bench.mine() if payload != LARGE] == [str(i) for i in range(60)]
    counts = []

    def counted():
        counts.extend(report.count for report in bench.passed.take(0.0))
        return sum(counts) == 63

    wait_until(counted, what="each to be counted once")


class FullLinks:
    """Links that have no room."""

    clear = False
    alone = False
    idle = False

    def takes(self, _):
        return False

    def slow(self):
        return 1, 1


@pytest.mark.parametrize(("moving", "waits"), [(True, True), (True, False), (False, True)])
def test_full_links_slow_down_only_what_must_not_be_dropped_and_only_while_they_move(stack, monkeypatch, moving, waits):
    """For a moment, where many are; else whoever brings a sample goes on at once. What finds no room is dropped."""
    bench = Bench(stack, most=2)
    control = zenoh.CongestionControl.BLOCK if waits else zenoh.CongestionControl.DROP
    held = bench.held("x", congestion_control=control)
    tuning = replace(TUNING, slowed=0, passing_backlog=1, moving=1e9 if moving else -1.0)
    monkeypatch.setattr(egress_module, "TUNING", tuning)
    waited = []
    monkeypatch.setattr(bench.egress._caught_up, "wait_for", lambda _, timeout: waited.append(timeout))
    bench.fill()
    for _ in range(3):
        bench.egress.pass_on("passed:no-spec", held)
    assert waited == [TUNING.catch_up] * (moving and waits)
    assert bench.egress.waiting["passing"] == 2


def test_whoever_is_slowed_down_by_full_links_goes_on_when_enough_was_sent(stack, monkeypatch):
    """Not only when nothing waits any more."""
    bench = Bench(stack, most=4)
    held = bench.held("x", congestion_control=zenoh.CongestionControl.BLOCK)
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, passing_backlog=3, moving=1e9, catch_up=60.0))
    bench.fill()
    for _ in range(3):
        bench.egress.pass_on("passed:no-spec", held)
    bringing = threading.Thread(target=bench.egress.pass_on, args=("passed:no-spec", held))
    bringing.start()
    wait_until(lambda: bench.egress._awaited == 3, what="the fourth, which waits")
    bench.egress.start()
    bringing.join(10.0)
    assert not bringing.is_alive()
    wait_until(lambda: len(bench.mine()) == 4, what="all of them")


@pytest.mark.parametrize(("slowed", "dropped"), [(1, 0), (0, 9)], ids=["one", "too many"])
def test_whoever_would_rather_wait_loses_nothing_while_the_mesh_moves(stack, monkeypatch, slowed, dropped):
    """It waits for as long as it takes, if not too many do: they keep threads that the apps need, too."""
    bench = Bench(stack, most=4)
    held = bench.held("x", congestion_control=zenoh.CongestionControl.BLOCK)
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, slowed=slowed, catch_up=0.0, moving=1e6))
    bench.fill()
    monkeypatch.setattr(Egress, "stands", False)
    bringing = threading.Thread(target=lambda: [bench.egress.pass_on("passed:no-spec", held) for _ in range(13)])
    bringing.start()
    wait_until(lambda: bench.egress._slowed or not bringing.is_alive(), what="the one that waits, or is not let")
    bench.egress.start()
    bringing.join(60.0)
    wait_until(lambda: len(bench.mine()) == 13 - dropped, what="all others")
    assert sum(report.count for report in bench.passed.take(0.0) if report.reason == FULL) == dropped


def test_whoever_waits_for_a_mesh_goes_on_when_it_stands_or_the_daemon_ends(stack, monkeypatch):
    """What finds no place then is dropped."""
    bench = Bench(stack, most=1)
    held = bench.held("x", congestion_control=zenoh.CongestionControl.BLOCK)
    bench.fill()
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, moving=0.0, catch_up=0.0))
    for _ in range(2):
        bench.egress.pass_on("passed:no-spec", held)
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, moving=60.0, catch_up=0.0))
    monkeypatch.setattr(Egress, "stands", False)
    bringing = threading.Thread(target=bench.egress.pass_on, args=("passed:no-spec", held))
    bringing.start()
    wait_until(lambda: bench.egress._slowed, what="the one that waits")
    bench.egress.close(1.0)
    bringing.join(30.0)
    assert [(report.reason, report.count) for report in bench.passed.take(0.0)] == [(FULL, 2)]


def test_where_patience_runs_out_a_sample_may_be_dropped(bench, monkeypatch, caplog):
    """It is published as one that may be, which is counted and said; others see that only while a link is full."""
    bench.fill()
    monkeypatch.setattr(bench.egress.writer._slow_links, "stays_full", lambda: True)
    bench.forward(1, bench.held("x", congestion_control=zenoh.CongestionControl.BLOCK))
    bench.egress.start()
    wait_until(bench.mine, what="the sample")
    (sample,) = [s for s in bench.heard.samples if s.timestamp is not None]
    assert sample.congestion_control == zenoh.CongestionControl.DROP
    assert bench.egress.writer.risked == 1
    assert "a link takes much less than the others" in caplog.text


def test_while_links_have_room_nobody_asks_for_patience(bench, monkeypatch):
    """What they take goes as it is."""
    monkeypatch.setattr(SendBuffers, "alone", False)
    asked = []
    monkeypatch.setattr(bench.egress.writer._slow_links, "stays_full", lambda: asked.append(True))
    bench.forward(1, bench.held("x", congestion_control=zenoh.CongestionControl.BLOCK))
    bench.egress.start()
    wait_until(bench.mine, what="the sample")
    assert not asked


def test_a_closed_session_refuses_and_is_said_once(bench, caplog):
    """Errors of the session are answers, not silence, and one line in the log."""
    held = bench.held("x")
    bench.mesh.close()
    bench.egress.start()
    for number in (1, 2):
        bench.forward(number, held)
    wait_until(lambda: len(bench.posted) == 2, what="both refusals")
    bench.egress.pass_on("passed:no-spec", held)
    assert {type(event) for event in bench.posted} == {SampleRefused}
    counted = []
    wait_until(lambda: counted.extend(bench.passed.take(0.0)) or counted, what="the count")
    assert counted[0].reason == "dropped:egress"
    assert sum("refuses" in record.message for record in caplog.records) == 1


def test_a_closed_egress_takes_nothing(bench):
    """After closing, forwarding is refused at once."""
    held = bench.held("x")
    bench.egress.start()
    bench.egress.close(1.0)
    bench.forward(7, held)
    assert [event.sample for event in bench.posted] == [7]


def test_of_many_that_wait_each_takes_its_own_memory(bench, monkeypatch):
    """Also those that pass behind decided ones of their key, as in shadow."""
    monkeypatch.setattr(egress_module, "TUNING", replace(TUNING, few_held=1))
    bench.forward(0, bench.held("decided"))
    for reason in ("first", "second"):
        bench.egress.pass_on(reason, bench.held(reason))
    assert bench.egress.waiting == {"decided": 3, "passing": 0}
    waiting = [bench.egress._decided.take(float("inf")) for _ in range(3)]
    assert [isinstance(held.sample, Parcel) for _, held in waiting] == [False, False, True]


def test_what_waits_takes_no_shared_memory_of_its_publisher(bench):
    """Who publishes from a pool has that back, however long the mesh takes no more."""
    buffer = shm.ShmProvider.default_backend(1 << 20).alloc(600_000)
    bench.forward(0, bench.held(zenoh.ZBytes(buffer)))
    _, waiting = bench.egress._decided.take(float("inf"))
    assert (waiting.size, waiting.shared) == (600_000, False)
