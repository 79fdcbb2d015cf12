"""Who is in the fleet."""

import pytest

from proxy.top.fleet import namesakes, robots, rows
from proxy.top.rates import Change
from tests.proxy.top.statuses import R1, R2, R3, later


def changes(*statuses):
    return {status["zid"]: Change(status).then(later(status)) for status in statuses}


def test_one_daemon_tells_of_the_whole_fleet():
    """Each robot has one row, with sums over its streams."""
    found = robots(changes(R1))
    assert [(robot.name, robot.itself) for robot in found] == [("r1", True), ("r2", False), ("r3", False)]
    first, second, _ = rows(found)
    assert (first["made"], first["sent"], first["unsent"]) == pytest.approx((30.0, 18.0, 12.0))
    assert (first["streams"], first["seen_by"], first["latency_out"]) == (3, "itself", None)
    assert (second["streams"], second["seen_by"], second["version"]) == (3, "r1", R2["version"])
    assert second["latency_out"] == R1["peers"][[p["robot"] for p in R1["peers"]].index("r2")]["latency_out"]


def test_a_robot_that_answers_itself_is_not_told_of_by_others():
    """Three daemons are three robots."""
    found = robots(changes(R1, R2, R3))
    assert [(robot.name, robot.itself) for robot in found] == [("r1", True), ("r2", True), ("r3", True)]


def test_two_robots_of_one_name_have_a_part_of_their_ids_behind_it():
    """Whether they answer themselves, or others have put it there already."""
    other = R2 | {"robot": "r1", "zid": "beef" + R2["zid"][4:], "peers": []}
    found = robots(changes(R1 | {"peers": []}, other))
    assert [robot.name for robot in found] == sorted([f"r1 ({R1['zid'][:4]})", "r1 (beef)"])
    assert namesakes(found) == ["r1"]
    peer = R1["peers"][0] | {"robot": "r1-cafe", "zid": "cafe1234"}
    seen = robots(changes(R1 | {"peers": [peer]}))
    assert [robot.name for robot in seen] == sorted([f"r1 ({R1['zid'][:4]})", "r1 (cafe)"])
    assert {robot.called for robot in seen} == {"r1", "r1-cafe"}


def test_of_a_robot_without_streams_no_rate_is_known():
    """It has a row all the same."""
    (row,) = rows(robots({"a": Change({"robot": "a", "zid": "a"})}))
    assert (row["robot"], row["made"], row["age"], row["streams"]) == ("a", None, None, 0)
