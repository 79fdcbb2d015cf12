"""What a robot does when all are ordered to."""

import pytest

from proxy.config import Config, FleetConfig
from proxy.core.model.mode import Mode
from proxy.orders import FROM_ANYBODY, orders
from proxy.pushed import pack
from proxy.reloading import Loaded, Reloading, read_specs
from tests.proxy.test_pushed import GOOD, OTHER, contents


class Robot:
    """Its files, and what was put in force of them. `config` is what it reads as its configuration."""

    def __init__(self, folder, fleet, *, guarded=True):
        self.folder = folder
        self.config = Config(robot="r1", fleet=fleet)
        self.config = self.config.model_copy(update={"specs": self.config.specs.model_copy(update={"path": folder})})
        self.modes = []
        loaded = Loaded(self.config, read_specs(folder))
        self.reloading = Reloading(loaded, None, lambda: self.config, lambda *_: None)
        self.obeyed = orders(fleet, "r1", self.modes.append, self.reloading, guarded=guarded)


@pytest.fixture
def robot(tmp_path):
    folder = tmp_path / "specs.d"
    folder.mkdir()
    (folder / "old.toml").write_bytes(GOOD)
    return Robot(folder, FleetConfig(specs=True, mode=True))


def test_nothing_is_obeyed_unless_it_is_allowed(robot):
    """The default is to obey nobody."""
    assert not Robot(robot.folder, FleetConfig()).obeyed
    assert list(Robot(robot.folder, FleetConfig(mode=True)).obeyed) == ["mode"]
    assert list(Robot(robot.folder, FleetConfig(specs=True)).obeyed) == ["specs"]


def test_a_mode_is_switched_to(robot):
    """And confirmed."""
    outcome = robot.obeyed["mode"](b"shadow")
    assert (outcome.robot, outcome.obeyed, outcome.said) == ("r1", True, ("mode shadow",))
    assert robot.modes == [Mode.SHADOW]


@pytest.mark.parametrize("raw", [b"fast", b"", b"\xff"])
def test_no_mode_is_refused(robot, raw):
    """With those that there are."""
    outcome = robot.obeyed["mode"](raw)
    assert (outcome.obeyed, outcome.said) == (False, ("a mode is one of pass, shadow, enforce",))
    assert not robot.modes


PYTHON = GOOD + b'features.x = { kind = "python", function = "operator:contains" }\n'


def test_python_runs_only_for_operators(robot):
    """A function of a library that takes two values is enough to have a robot run anything."""
    anybody = Robot(robot.folder, FleetConfig(specs=True), guarded=False)
    outcome = anybody.obeyed["specs"](pack({"new.toml": PYTHON}))
    assert not outcome.obeyed
    (said,) = outcome.said
    assert said.startswith("new.toml:")
    assert said.endswith(f'"operator:contains" is not imported: {FROM_ANYBODY}')
    assert contents(robot.folder) == {"old.toml": GOOD}
    assert anybody.obeyed["specs"](pack({"new.toml": OTHER})).obeyed
    assert robot.obeyed["specs"](pack({"new.toml": PYTHON})).obeyed


def test_specs_are_put_in_force(robot):
    """They replace the old ones, and the robot says which are in force now."""
    outcome = robot.obeyed["specs"](pack({"new.toml": OTHER}))
    specs = robot.reloading.loaded.specs
    assert (outcome.obeyed, outcome.said) == (True, (f"specs {specs.generation} in force",))
    assert specs.types[0].scale({}) == 2.0
    assert contents(robot.folder) == {"new.toml": OTHER}


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        (b"rubbish", ("what was pushed cannot be read",)),
        (
            pack({"a.toml": GOOD.replace(b"video", b"vidoe"), "b.toml": b"x"}),
            ('a.toml:6: information_type "camera": utility.kind: ', "b.toml:1: not valid TOML: "),
        ),
        (
            pack({"a.toml": GOOD + b'aggregation = { python = "tests.utility_specs.models:Hiding" }\n'}),
            ("cannot be judged: RuntimeError: one two",),
        ),
    ],
)
def test_specs_with_mistakes_change_nothing(robot, raw, said):
    """Every mistake is told."""
    outcome = robot.obeyed["specs"](raw)
    assert not outcome.obeyed
    assert [line.startswith(start) for line, start in zip(sorted(outcome.said), said, strict=True)] == [True] * len(
        said
    )
    assert contents(robot.folder.parent) == {"specs.d/old.toml": GOOD}
    assert robot.reloading.loaded.specs.types[0].scale({}) == 1.0


def test_specs_that_cannot_be_in_force_are_taken_back(robot):
    """Something else keeps the robot from reloading: then the folder, too, is as it was."""
    robot.config = robot.config.model_copy(update={"robot": "r2"})
    outcome = robot.obeyed["specs"](pack({"new.toml": OTHER}))
    assert not outcome.obeyed
    assert '"r1" is in force, not "r2"' in outcome.said[0]
    assert contents(robot.folder.parent) == {"specs.d/old.toml": GOOD}


def test_who_is_busy_says_so(robot):
    """What it says comes back with what the others say."""

    def busy(_):
        raise TimeoutError

    obeyed = orders(FleetConfig(mode=True), "r1", busy, robot.reloading, guarded=True)
    outcome = obeyed["mode"](b"shadow")
    assert (outcome.obeyed, outcome.said) == (False, ("it is busy, and will do it later",))
