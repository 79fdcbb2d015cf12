"""What an operator's own model does to decisions when it fails or never ends."""

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.full
MODEL = """
import os, time
FAULT = "{fault}"
class Model:
    def empty(self):
        return 0.0
    def add(self, state, message):
        if os.path.exists(FAULT):
            with open(FAULT) as file:
                kind = file.read()
            if kind == "raises":
                raise RuntimeError("the model is broken")
            while os.path.exists(FAULT):
                time.sleep(0.01)
        return state + message.scale
    def value(self, state, t_end):
        return state
"""


class Broken(Fault):
    """The model of all robots `raises`, or `hangs`: each call of it until the fault is over."""

    def __init__(self, file, kind):
        self._file = file
        self._kind = kind

    def start(self):
        self._file.with_suffix(".new").write_text(self._kind)
        self._file.with_suffix(".new").rename(self._file)

    def stop(self):
        self._file.unlink()


@pytest.mark.parametrize("kind", ["raises", "hangs"])
def test_without_a_planner_a_static_rule_decides(play, tmp_path, kind):
    """Samples go on within the limit, each is accounted for, the fault is told; afterwards it plans again."""
    fault = tmp_path / "fault"
    (tmp_path / "own_model.py").write_text(MODEL.format(fault=fault))
    # Too much for the limit: every sample is decided.
    scene = play(aggregation='{ python = "own_model:Model" }', limit="400 kbit/s", size=4000, PYTHONPATH=str(tmp_path))
    decided = scene.first.status()["decisions"]["made"]
    wait_until(lambda: scene.first.status()["decisions"]["made"] > decided, what="decisions of the model")
    with Broken(fault, kind):
        before = fallbacks(scene)
        wait_until(lambda: fallbacks(scene) > before + 10, what="decisions by the static rule")
        scene.go_on()
    assert told(kind, scene.first)
    decided = scene.first.status()["decisions"]["made"]
    wait_until(lambda: scene.first.status()["decisions"]["made"] > decided + 5, 30.0, "decisions of the model again")
    counts = scene.finish(ordered=False)
    assert counts["dropped"] > 0


def told(kind, robot):
    """Whether an operator finds out."""
    return "the model is broken" in robot.log() if kind == "raises" else robot.status()["decisions"]["late"]


def fallbacks(scene):
    """How many samples the static rule has decided."""
    reasons = scene.first.status()["counts"]["by_reason"]
    return sum(reasons.get(each, 0) for each in ("passed:fallback", "dropped:fallback"))
