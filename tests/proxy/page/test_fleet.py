"""What the page shows of a fleet."""

import copy

import pytest

from proxy.page.fleet import delays, described
from proxy.page.frames import Delay
from proxy.page.specs import InForce
from proxy.top.frames import Scene
from proxy.top.rates import Change
from tests.proxy.top.statuses import R1, R2, later


def scene(*statuses, away=""):
    return Scene({each["zid"]: Change(each).then(later(each)) for each in statuses}, away)


def test_each_robot_is_told_once_with_its_types():
    """By itself where it answers, else as another one sees it, who does not know why."""
    told = described(scene(R1), InForce("abc"), {"robot/r1/camera": 4.0}, "r1")
    assert [robot["robot"] for robot in told["robots"]] == ["r1", "r2", "r3"]
    own, other, _ = told["robots"]
    assert (own["itself"], other["itself"], other["seen_by"]) == (True, False, "r1")
    for row in own["types"]:
        assert row["unsent"] == pytest.approx(row["made"] - row["sent"])
        assert row["why_known"]
        assert row["why"][0]["words"] == "others are worth more for what is left"
    assert all(not row["why_known"] and row["why"] == [] for row in other["types"])
    assert {each["key"]: each["rate"] for each in told["streams"]}["robot/r1/camera"] == 4.0
    assert [limit["constraint"] for limit in told["limits"]] == [each["constraint"] for each in R1["budget"]]
    assert told["worth"] is None


def test_streams_of_a_type_are_one_row():
    """Their numbers are added up."""
    more = copy.deepcopy(R1)
    (stream, *_) = [each for each in more["streams"] if each["robot"] == "r1"]
    more["streams"].append(stream | {"key": "robot/r1/other"})
    alone, both = (
        next(
            row
            for row in described(scene(each), InForce(), {}, "r1")["robots"][0]["types"]
            if row["type"] == stream["type"]
        )
        for each in (R1, more)
    )
    assert len(both["keys"]) == len(alone["keys"]) + 1
    assert both["generated"] == alone["generated"] + stream["generated"] + 20
    assert both["why"][0]["rate"] > alone["why"][0]["rate"]


def test_what_is_wrong_is_told():
    """By whom, and that nobody answers."""
    wrong = copy.deepcopy(R2) | {"warnings": ["the clock is wrong"]}
    same = copy.deepcopy(R1) | {"zid": "1234567890"}
    told = described(scene(R1, wrong, same, away="no daemon answers"), InForce(problem="x"), {}, "nobody")
    assert "r2: the clock is wrong" in told["warnings"]
    assert any(each.startswith("several robots are called r1") for each in told["warnings"])
    assert (told["away"], told["problem"], told["limits"]) == ("no daemon answers", "x", [])


def test_the_way_from_each_robot_is_known_where_its_daemon_is():
    """Clock and latency, by the keys of its samples."""
    peer = next(each for each in R1["peers"] if each["robot"] == "r2")
    found = delays(scene(R1), "r1")
    key = next(each["key"] for each in R1["streams"] if each["robot"] == "r2")
    assert found[key] == Delay(peer["wall_ahead"], peer["latency_in"]["fixed"], peer["latency_in"]["per_byte"])
    assert delays(Scene({}), "r1") == {}
