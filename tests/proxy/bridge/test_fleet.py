"""Orders for all robots, between real sessions."""

import json
from dataclasses import replace

import pytest

from proxy.bridge import fleet as fleet_module
from proxy.bridge import keys
from proxy.bridge.fleet import Fleet, Outcome, read_outcomes
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import answers, closing, free_endpoint, plain_session
from tests.waiting import wait_until


class Robot:
    """One robot. `got` are the orders that it obeyed."""

    def __init__(self, stack, name, allowed=("mode",), connect=(), members=()):
        self.name, self.got = name, []
        self.app_endpoint, self.mesh_endpoint = free_endpoint(), free_endpoint()
        app = closing(stack, plain_session("router", listen=(self.app_endpoint,)))
        self.mesh = closing(stack, plain_session("peer", listen=(self.mesh_endpoint,), connect=connect))
        executor = SerialExecutor(f"fleet {name}")
        stack.callback(executor.close, 1.0)
        fleet = Fleet(
            app=app,
            mesh=self.mesh,
            robot=name,
            executor=executor,
            obeyed=dict.fromkeys(allowed, self._obey),
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


@pytest.fixture
def team(stack, monkeypatch):
    """Three robots; the third obeys nothing."""
    patient = replace(TUNING, order_wait=30.0)  # a busy machine needs longer than operators wait
    monkeypatch.setattr(fleet_module, "TUNING", patient)
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


def test_orders_are_taken_from_the_mesh_only_where_they_are_allowed(team):
    """What is not allowed is not even there to be asked."""
    assert list(answers(team[0].mesh, keys.fleet("*", "specs"), payload=b"x")) == []


@pytest.mark.parametrize("payload", [None, bytes(2 * 1024 * 1024 + 1)])
def test_an_order_without_a_proper_payload_is_refused(team, payload):
    """Nobody obeys nothing, or too much."""
    (answer,) = answers(team[0].operator, keys.to_fleet("r1", "mode"), payload=payload)
    assert answer == "error: the order is empty or too large"
    assert not team[1].got


@pytest.mark.parametrize("raw", [b"", b"{}x", b"[1]", json.dumps([{"robot": "r1"}]).encode(), b"3"])
def test_answers_that_are_none_are_left_out(raw):
    """Another version, or somebody else who serves the key."""
    assert read_outcomes(raw) == []
