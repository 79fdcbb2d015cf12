"""Orders for all robots, between real sessions."""

import json
import threading
from dataclasses import replace

import pytest
import zenoh

from proxy.bridge import fleet as fleet_module
from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.fleet import Fleet, Outcome, read_outcomes
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import answers, closing, free_endpoint, plain_session
from tests.waiting import wait_until


class Robot:
    """One robot. `got` are the orders that it obeyed."""

    def __init__(self, stack, name, allowed=("mode",), connect=(), *, members=(), obey=None):
        self.name, self.got = name, []
        self.app_endpoint, self.mesh_endpoint = free_endpoint(), free_endpoint()
        app = closing(stack, plain_session("router", listen=(self.app_endpoint,)))
        self.mesh = closing(stack, plain_session("peer", listen=(self.mesh_endpoint,), connect=connect))
        executor, passing = (SerialExecutor(f"{kind} {name}") for kind in ("fleet", "fleet out"))
        for each in (executor, passing):
            stack.callback(each.close, 1.0)
        fleet = Fleet(
            app=app,
            mesh=self.mesh,
            robot=name,
            executor=executor,
            passing=passing,
            obeyed=dict.fromkeys(allowed, obey or self._obey),
            members=lambda: members,
        )
        stack.callback(fleet.close)
        self.operator = closing(stack, plain_session("client", connect=(self.app_endpoint,)))

    def _obey(self, raw):
        self.got.append(raw)
        return Outcome(self.name, obeyed=raw != b"nonsense", said=(f"did {raw.decode()}",))

    def order(self, order, payload):
        (answer,) = answers(self.operator, keys.to_fleet(self.name, order), payload=payload)
        return [(outcome.robot, outcome.obeyed, *outcome.said) for outcome in read_outcomes(answer.encode())]


@pytest.fixture(autouse=True)
def _patience(monkeypatch):
    """A busy machine needs longer than operators wait."""
    monkeypatch.setattr(fleet_module, "TUNING", replace(TUNING, order_wait=30.0))


@pytest.fixture
def team(stack):
    """Three robots; the third obeys nothing."""
    first = Robot(stack, "r1", members=("r2", "r3"))
    second = Robot(stack, "r2", connect=(first.mesh_endpoint,))
    third = Robot(stack, "r3", allowed=(), connect=(first.mesh_endpoint,))
    wait_until(lambda: len(first.mesh.info.peers_zid()) == 2, what="the links")
    wait_until(
        lambda: first.mesh.declare_querier(keys.fleet("r2", "mode")).matching_status.matching, what="the queryable"
    )
    return first, second, third


def test_an_order_reaches_all_who_obey_it(team):
    """Each answers for itself, also the one it is given to; who does not obey is named as silent."""
    assert team[0].order("mode", b"shadow") == [
        ("r1", True, "did shadow"),
        ("r2", True, "did shadow"),
        ("r3", False, "no answer: it is out of reach, or fleet.mode is false in its configuration"),
    ]
    assert [robot.got for robot in team] == [[b"shadow"], [b"shadow"], []]


def test_what_is_refused_is_told(team):
    """A robot says why it did not obey."""
    assert [obeyed for _, obeyed, _ in team[0].order("mode", b"nonsense")] == [False] * 3


def test_who_passes_an_order_on_need_not_obey_it(team):
    """Its own configuration counts for itself."""
    assert team[2].order("specs", b"x") == [("r3", False, "fleet.specs is false in its configuration")]


def test_orders_of_two_operators_that_cross_wait_for_nobody(stack):
    """Who passes one on refuses another one of its kind at once, and obeys all else; later it obeys that kind, too."""
    asked, done = threading.Event(), threading.Event()
    stack.callback(done.set)

    def slow(raw):
        asked.set()
        return Outcome("r2", obeyed=done.wait(60.0), said=(raw.decode(),))

    first = Robot(stack, "r1", allowed=("mode", "specs"), members=("r2",))
    second = Robot(stack, "r2", connect=(first.mesh_endpoint,), obey=slow)
    other = closing(stack, plain_session("peer", connect=(first.mesh_endpoint,)))
    for session, key in ((first.mesh, keys.fleet("r2", "mode")), (other, keys.fleet("r1", "specs"))):
        querier = session.declare_querier(key)
        wait_until(lambda querier=querier: querier.matching_status.matching, what="the queryables")
    passed_on = []
    operator = threading.Thread(target=lambda: passed_on.extend(first.order("mode", b"enforce")))
    operator.start()
    assert asked.wait(60.0)

    def ordered(order, payload):
        (answer,) = answers(other, keys.fleet("r1", order), payload=payload)
        return [(outcome.obeyed, *outcome.said) for outcome in read_outcomes(answer.encode())]

    ((obeyed, said),) = ordered("mode", b"shadow")
    assert not obeyed
    assert "at the same time" in said
    assert ordered("specs", b"some") == [(True, "did some")]
    done.set()
    operator.join(60.0)
    assert passed_on == [("r1", True, "did enforce"), ("r2", True, "enforce")]
    assert ordered("mode", b"pass") == [(True, "did pass")]
    assert (first.got, second.got) == ([b"some", b"enforce", b"pass"], [])


def test_robots_of_one_name_answer_each_for_itself(stack):
    """As after a partition: the operator sees what each did, and whether one of them is silent."""
    first = Robot(stack, "r1", members=("r2", "r2", "r2", "r1"))
    for name in ("r1", "r2", "r2"):
        Robot(stack, name, connect=(first.mesh_endpoint,))
    wait_until(lambda: sum(obeyed for _, obeyed, _ in first.order("mode", b"pass")) == 4, what="all that are there")
    silent = "no answer: it is out of reach, or fleet.mode is false in its configuration"
    assert sorted(first.order("mode", b"pass")) == [
        *[("r1", True, "did pass")] * 2,
        ("r2", False, silent),
        *[("r2", True, "did pass")] * 2,
    ]


def test_a_robot_answers_for_itself_alone(team):
    """What one on the mesh says of others is left out, be it in words that are read or not."""
    said = [{"robot": robot, "obeyed": False, "said": ["no"]} for robot in ("r2", "r1", "r9", "r9-0a")]
    answered = []

    def lie(query):
        with query:
            for payload in (b"[" * 100_000, json.dumps(said).encode(), bytes(BOUNDS.answers_bytes)):
                query.reply(keys.fleet("r9", "mode"), payload)
        answered.append(query)

    mesh = team[2].mesh
    mesh.declare_queryable(keys.fleet("r9", "mode"), zenoh.handlers.Callback(lie, indirect=False))
    querier = team[0].mesh.declare_querier(keys.fleet("r9", "mode"))
    wait_until(lambda: querier.matching_status.matching, what="the queryable")
    assert team[0].order("mode", b"shadow") == [
        ("r1", True, "did shadow"),
        ("r2", True, "did shadow"),
        ("r3", False, "no answer: it is out of reach, or fleet.mode is false in its configuration"),
        ("r9", False, "no"),
    ]
    assert answered


def test_a_robot_that_answers_too_much_takes_no_room_from_others(stack, monkeypatch):
    """Nor is it read: JSON of 16 MB takes up to 400 MB then, and systemd would kill the daemon."""
    answered, lengths = threading.Event(), []
    stack.callback(answered.set)
    read = fleet_module.read_outcomes
    monkeypatch.setattr(fleet_module, "read_outcomes", lambda raw: lengths.append(len(raw)) or read(raw))

    def wait(raw):
        return Outcome("r2", obeyed=answered.wait(60.0), said=(raw.decode(),))

    def lie(query):
        with query:
            for size in (BOUNDS.answers_bytes, *[BOUNDS.answer_bytes] * 17):
                query.reply(keys.fleet("r9", "mode"), b" " * size)
        answered.set()

    first = Robot(stack, "r1", members=("r2", "r9"))
    Robot(stack, "r2", connect=(first.mesh_endpoint,), obey=wait)
    liar = closing(stack, plain_session("peer", connect=(first.mesh_endpoint,)))
    liar.declare_queryable(keys.fleet("r9", "mode"), zenoh.handlers.Callback(lie, indirect=False))
    for key in (keys.fleet("r2", "mode"), keys.fleet("r9", "mode")):
        querier = first.mesh.declare_querier(key)
        wait_until(lambda querier=querier: querier.matching_status.matching, what="the queryables")
    assert first.order("mode", b"pass")[:2] == [("r1", True, "did pass"), ("r2", True, "pass")]
    assert sum(length > BOUNDS.answer_bytes // 2 for length in lengths) == 1


def test_orders_are_taken_from_the_mesh_only_where_they_are_allowed(team):
    """What is not allowed is not even there to be asked."""
    assert list(answers(team[0].mesh, keys.fleet("*", "specs"), payload=b"x")) == []


@pytest.mark.parametrize("payload", [None, bytes(2 * 1024 * 1024 + 1)])
def test_an_order_without_a_proper_payload_is_refused(team, payload):
    """Nobody obeys nothing, or too much."""
    (answer,) = answers(team[0].operator, keys.to_fleet("r1", "mode"), payload=payload)
    assert answer == "error: the order is empty or too large"
    assert not team[1].got


@pytest.mark.parametrize("raw", [b"", b"{}x", b"[1]", b"[" * 100_000, json.dumps([{"robot": "r1"}]).encode(), b"3"])
def test_answers_that_are_none_are_left_out(raw):
    """Another version, or somebody else who serves the key."""
    assert read_outcomes(raw) == []
