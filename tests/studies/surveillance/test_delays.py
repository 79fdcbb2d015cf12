"""What decisions add, of logs made by hand."""

import json

import pytest

from studies.surveillance.delays import _delay


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
