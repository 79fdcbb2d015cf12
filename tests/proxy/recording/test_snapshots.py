"""Snapshots of cores: what is put together again does as the core would."""

import platform
from dataclasses import replace

import pytest

from proxy.core.core import Core
from proxy.core.model.settings import CoreSettings
from proxy.recording.errors import RecordingError
from proxy.recording.snapshots import check, restored, taken
from proxy.recording.tuning import RecordingTuning
from proxy.version import version
from tests.proxy.recording.flights import fewer_types, flown
from utility_specs import Specs


@pytest.mark.full
@pytest.mark.parametrize(
    ("workload", "robots", "team", "loss", "change"),
    [
        pytest.param("mixed", 2, "announce/unicast", 0.01, None, marks=pytest.mark.full),
        ("mixed", 2, "announce/unicast", 0.01, fewer_types),
        pytest.param("random", 3, "announce/broadcast", 0.1, None, marks=pytest.mark.full),
        ("cameras", 3, "split/unicast", 0.01, None),
    ],
)
def test_a_core_put_together_again_does_the_same(workload, robots, team, loss, change):
    """Whatever it was doing: every command is equal, also where a search was under way, and over a reload."""
    cores = flown(workload, robots, team, loss=loss, change=change)
    assert sum(core.snapshots for core in cores) > 10
    assert any(core.searching for core in cores)


@pytest.fixture
def core():
    return Core(CoreSettings("r1", "z1", version=version()), Specs.empty(), 1.0)


def test_a_snapshot_says_what_it_is_of(core):
    """Of which event and specs, and by which versions."""
    snapshot = taken(core, 7, 2.0)
    assert (snapshot.number, snapshot.now, snapshot.generation) == (7, 2.0, "0" * 12)
    assert (snapshot.version, snapshot.python) == (version(), platform.python_version())
    check(snapshot)
    assert isinstance(restored(snapshot, Specs.empty()), Core)


@pytest.mark.parametrize("other", [{"version": "0.0.1"}, {"python": "3.7.1"}])
def test_one_of_another_version_is_refused(core, other):
    """It says which version it takes, and what can be done without."""
    with pytest.raises(
        RecordingError, match=r"(Sendworthy 0.0.1|Python 3.7.1).*takes that version; `--policy planner`"
    ):
        check(replace(taken(core, 0, 1.0), **other))


def test_another_micro_version_of_python_decides_the_same(core):
    """Numbers are the same."""
    check(replace(taken(core, 0, 1.0), python=".".join([*platform.python_version().split(".")[:2], "99"])))


def test_snapshots_are_bounded(core, monkeypatch):
    """Neither a larger one is taken, nor read."""
    snapshot = taken(core, 0, 1.0)
    monkeypatch.setattr("proxy.recording.snapshots.TUNING", RecordingTuning(snapshot=100))
    with pytest.raises(RecordingError, match="bytes are too many"):
        taken(core, 0, 1.0)
    with pytest.raises(RecordingError, match="claims to have"):
        restored(snapshot, Specs.empty())


def test_what_is_no_core_is_refused(core):
    """Though all of it may be read."""
    snapshot = replace(taken(core, 0, 1.0), data=b"\x80\x05N.")
    with pytest.raises(RecordingError, match="none of a core"):
        restored(snapshot, Specs.empty())
