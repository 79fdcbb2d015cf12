"""What decisions add, of logs made by hand."""

import json

import pytest

from planner import Plan
from proxy.core.interface.events import DecisionReady, SamplePublished, TimePassed
from proxy.recording.entries import Gap, Happened
from proxy.recording.errors import RecordingError
from studies.surveillance.delays import _delay, waited


def log(path, *entries):
    path.write_text("".join(json.dumps(entry) + "\n" for entry in entries))


def test_a_frame_is_sent_with_its_first_byte_on_the_medium(tmp_path):
    """Chunks that are no frames do not count, nor do those to other places, and what was dropped has no delay."""
    publish = {"event": "publish", "robot": "r1", "size": 35_000, "red": 0.0}
    receive = {"event": "receive", "robot": "r1", "size": 35_000, "t_gen": 0.0}
    serve = {"event": "serve", "source": "r1", "sink": "operator"}
    log(tmp_path / "camera.jsonl", *(publish | {"number": n, "t": float(n)} for n in range(3)))
    log(tmp_path / "operator.jsonl", receive | {"number": 0, "t": 0.2}, receive | {"number": 2, "t": 2.1})
    log(
        tmp_path / "medium.jsonl",
        serve | {"t": 0.01, "size": 90},
        serve | {"t": 0.02, "size": 4096, "sink": "r1", "source": "operator"},
        serve | {"t": 0.05, "size": 4096},
        serve | {"t": 0.06, "size": 4096},
        serve | {"t": 2.05, "size": 4096},
    )
    found = _delay("by hand", tmp_path, {"made": 4, "seconds": 0.02, "longest": 0.01})
    assert found.frames == 2
    assert found.sent == pytest.approx((0.05, 0.05))
    assert found.arrived[0] == pytest.approx(0.15)
    assert (found.decided, found.seconds, found.longest) == (4, pytest.approx(0.005), 0.01)


def frame(number, now, **rest):
    return SamplePublished(now, number, "robot/r1/camera", 35_000, now, None, 5, {}, **rest)


def happened(event, *commands):
    return Happened(0, event, tuple({"command": name} | fields for name, fields in commands))


def test_a_frame_that_is_decided_later_than_it_came_waited():
    """Those that gave way to newer ones count as frames; what was dropped in the end did not wait to be sent."""
    plan = Plan(True, (0,), 1.0, None, 1, 1)
    recording = [
        happened(frame(10, 1.0), ("Decide", {"asked": 1.0})),
        happened(DecisionReady(1.002, 1, plan), ("Forward", {"sample": 10})),
        happened(frame(11, 1.1, superseded=2)),
        happened(TimePassed(1.15), ("Decide", {"asked": 1.15})),
        happened(DecisionReady(1.152, 2, plan), ("Forward", {"sample": 11})),
        happened(frame(12, 1.2)),
        happened(TimePassed(1.25), ("Decide", {"asked": 1.25})),
        happened(DecisionReady(1.252, 3, plan), ("Drop", {"sample": 12})),
    ]
    assert list(waited(recording)) == [3]
    with pytest.raises(RecordingError, match="7 events are missing"):
        list(waited([*recording, Gap(9, 7)]))
