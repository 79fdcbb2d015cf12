"""What a status says of one stream."""

import pytest

from proxy.live_streams import competing, known, live_data, streams_of
from utility_specs import load_specs

CAMERA = {
    "robot": "r1",
    "key": "robot/r1/camera",
    "type": "camera",
    "schedule": "periodic",
    "period": 0.1,
    "jitter": 0.002,
    "forecast": {"red": "trend"},
    "size": 40_000,
    "scale": 4.5,
    "generated": 120,
    "forwarded": 80,
    "by_reason": {"dropped:planner": 30, "forwarded": 80},
    "receivers": 1,
    "last_generated": 0.034,
    "last_forwarded": None,
}
STATUS = {
    "robot": "r1",
    "mode": "enforce",
    "specs": "abc",
    "streams": [
        CAMERA | {"robot": "r2", "receivers": 2, "forecast": {}, "by_reason": {}},
        CAMERA,
        CAMERA | {"key": "robot/r1/stop", "type": "stop", "size": 50, "receivers": 0},
        CAMERA | {"key": "robot/r1/old", "type": "old"},
    ],
    "decisions": {
        "last": {
            "key": "robot/r1/camera",
            "reason": "dropped:planner",
            "send": False,
            "age": 0.5,
            "utility": 5.42,
            "opposite": 5.35,
            "prices": {"throughput": 0.1, "airtime": 0.0},
            "binding": ["energy"],
        }
    },
    "counts": {"by_reason": {"forwarded": 80, "passed:no-spec": 200}},
}


@pytest.fixture
def specs(tmp_path):
    """Cameras, and what bypasses."""
    file = tmp_path / "specs.toml"
    file.write_text(
        '[[information_type]]\nname = "camera"\nkeys = ["robot/*/camera"]\nutility = { kind = "step", lifetime = 2 }\n'
        '[[information_type]]\nname = "stop"\nkeys = ["robot/*/stop"]\nutility = { kind = "step", lifetime = 2 }\n'
        "bypass = true\n"
    )
    return load_specs(file)


def test_a_stream_is_told_as_the_daemon_knows_it():
    """Its schedule, its forecast, what became of its samples, and why the last decision was what it was."""
    status = STATUS | {"streams": [CAMERA]}
    assert list(known(status, "robot/r1/camera")) == [
        "what robot r1 knows (mode enforce)",
        "  generates   periodic ±2%, every 100 ms, the last 34 ms ago",
        "  next ones   expected red by trend",
        "  samples     120 made, 80 sent, 40 not; the last sent never",
        "  decided on  30 dropped:planner (others are worth more for what is left)",
        "              80 forwarded",
        "  wanted by   1 robot",
        "  last one    dropped:planner (others are worth more for what is left), 500 ms ago",
        "              the team's best plan is worth 5.42 with it dropped, 0.07 less with it sent",
        "              scarce: throughput, energy",
        "  all keys    200 passed:no-spec, 80 forwarded",
    ]


def test_several_robots_may_have_a_key():
    """The daemon's own comes first, each by its robot."""
    assert [each["robot"] for each in streams_of(STATUS, "robot/r1/camera")] == ["r1", "r2"]
    lines = list(known(STATUS, "robot/r1/camera"))
    assert lines[1] == "  of r1"
    assert "  of r2" in lines
    assert "  next ones   expected to be like the last one" in lines
    assert "  wanted by   2 robots" in lines


def test_an_unknown_key_is_said_to_be_one():
    """What covers nothing, or is wanted by nobody, is no stream; another key's decision is not told."""
    lines = list(known(STATUS, "other"))
    assert lines[1].startswith("  nothing of this key: ")
    assert not any("last one" in line for line in lines)
    assert len(list(known({"robot": "r1"}, "other"))) == 3


@pytest.mark.parametrize(
    ("opposite", "text"), [(211.9, "0.1 less"), (212.004, "0.004 more"), (212.0, "the same"), (None, "-")]
)
def test_the_opposite_of_a_decision_is_told_by_how_much_it_differs(opposite, text):
    """Two plans for a whole team are worth nearly the same; what a reader wants to know is the difference."""
    last = STATUS["decisions"]["last"] | {"utility": 212.0, "opposite": opposite}
    lines = list(known(STATUS | {"decisions": {"last": last}}, "robot/r1/camera"))
    assert f"              the team's best plan is worth 212 with it dropped, {text} with it sent" in lines


@pytest.mark.parametrize(
    ("opposite", "lead", "told"),
    [(5.5, 0.03, True), (5.5, None, False), (5.5, -0.01, False), (5.35, 0.03, False), (None, 0.03, False)],
)
def test_why_the_plan_that_is_worth_less_in_the_window_was_taken_is_told(opposite, lead, told):
    """It leaves more room for what follows; else the line before would speak against the decision."""
    last = STATUS["decisions"]["last"] | {"opposite": opposite, "lead": lead}
    lines = list(known(STATUS | {"decisions": {"last": last}}, "robot/r1/camera"))
    assert ("              with what follows the window that is 0.03 less" in lines) is told


def test_a_decision_to_send_is_told_the_other_way_round():
    """Without scarcity nothing is said of it."""
    last = STATUS["decisions"]["last"] | {"send": True, "reason": "forwarded", "prices": {}, "binding": []}
    lines = list(known(STATUS | {"decisions": {"last": last}}, "robot/r1/camera"))
    assert "  last one    forwarded, 500 ms ago" in lines
    assert "              the team's best plan is worth 5.42 with it sent, 0.07 less with it dropped" in lines
    assert not any("scarce" in line for line in lines)


def test_streams_compete_by_what_their_bytes_are_worth(specs):
    """By what their last samples showed; what these specs do not know comes last."""
    found = competing(STATUS, specs, "robot/r1/camera")
    assert [(each.name, each.value, each.size, each.this, each.note) for each in found] == [
        ("robot/r1/stop of r1", 4.5, 50, False, "bypasses the planner, nobody wants it"),
        ("robot/r1/camera of r2", 4.5, 40_000, False, ""),
        ("robot/r1/camera of r1", 4.5, 40_000, True, ""),
        ("robot/r1/old of r1", None, 40_000, False, 'type "old" is not in these specs'),
    ]


def test_a_stream_that_is_over_is_said_to_be(specs):
    """Nothing is planned for it any more, so it hardly competes."""
    over = CAMERA | {"over": True}
    assert "  generates   over, the last 34 ms ago" in known(STATUS | {"streams": [over]}, "robot/r1/camera")
    (each,) = competing(STATUS | {"streams": [over]}, specs, "robot/r1/camera")
    assert each.note == "it is over"


@pytest.mark.parametrize("schedule", ["bursts 5 0.05", "poisson"])
def test_what_is_not_periodic_comes_so_often_on_average(schedule):
    """Nothing is claimed of when the next one comes."""
    stream = CAMERA | {"schedule": schedule}
    (line,) = [each for each in known(STATUS | {"streams": [stream]}, "robot/r1/camera") if "generates" in each]
    assert line.endswith(", every 100 ms on average, the last 34 ms ago")


def test_what_decisions_do_is_told_with_the_mode():
    """In shadow all is sent, whatever is decided."""
    assert (
        next(known(STATUS | {"mode": "shadow"}, "a")) == "what robot r1 knows (mode shadow: it decides, but sends all)"
    )
    assert "decides nothing" in next(known(STATUS | {"mode": "pass"}, "a"))


def test_scripts_get_what_the_daemon_said():
    """The decision only where it was one on the key."""
    data = live_data(STATUS, "robot/r1/camera")
    assert [each["robot"] for each in data["streams"]] == ["r1", "r2"]
    assert data["last_decision"]["reason"] == "dropped:planner"
    assert live_data(STATUS, "other")["last_decision"] is None
    assert live_data({}, "other")["streams"] == []
