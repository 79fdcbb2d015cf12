"""Missions of recordings."""

import pytest

from proxy.recording.entries import Start, Traffic
from proxy.recording.writing import RecordingWriter
from studies.bench.errors import BenchError
from studies.bench.format import read, text_of
from studies.bench.recorded import of_recording
from tests.studies.replay.traffic import POSE, samples, spec

LIMIT = '[[constraint]]\nkind = "throughput"\nlimit = "8 kbit/s"\nwindow = 1.0\n'
CAMERA = '[[information_type]]\nname = "camera"\nkeys = ["*/camera"]\nfeatures.red = { kind = "json", path = "red" }\n'


@pytest.fixture
def made(tmp_path):
    """Make a mission of 20 s of two streams, by a spec."""
    pytest.importorskip("scipy")
    told = sorted([*samples(), *samples(key="r2/pose", size=100)], key=lambda each: each.t)
    with RecordingWriter(tmp_path / "traffic.mcap", Start("traffic", source="a test")) as writer:
        for each in told:
            writer.traffic(Traffic(each.robot, each.key, t_gen=each.t, size=each.size, features=each.features))

    def make(text):
        (tmp_path / "spec.toml").write_text(text)
        return of_recording([tmp_path / "traffic.mcap"], [tmp_path / "spec.toml"], "made", latency=0.05)

    return make


def test_samples_limits_and_worths_are_taken_over(made, tmp_path):
    """Times count from the first sample; features are in the scale."""
    mission = made(spec() + POSE)
    assert [stream.key for stream in mission.streams] == ["r1/camera", "r2/pose"]
    assert mission.head.limits[0].model_dump() == {"kind": "throughput", "limit": 1000.0, "window": 1.0}
    assert mission.head.columns == ("t_gen", "stream", "size", "scale")
    assert mission.rows[0].scale == pytest.approx(1.0 + samples()[0].features["red"], abs=1e-5)
    assert (mission.rows[2].t_gen, mission.rows[2].size) == (0.5, 600)
    (tmp_path / "made.jsonl").write_text(text_of(mission))
    assert read(tmp_path / "made.jsonl") == mission


def test_what_no_spec_covers_is_left_out(made):
    """Nobody decides on it."""
    assert [stream.key for stream in made(spec()).streams] == ["r1/camera"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (LIMIT + POSE.replace("pose", "lidar"), "the specs cover no key"),
        (POSE, "the specs set no limit"),
        ('[[constraint]]\nkind = "energy"\nlimit = "5 J"\nper_byte = "0.1 J"\n' + POSE, "no limit of the kind energy"),
        (
            LIMIT + CAMERA + 'utility = { kind = "python", function = "tests.studies.bench.fading:fading" }\n',
            "r1/camera: its utility follows features",
        ),
    ],
)
def test_what_a_file_cannot_say_is_told(made, text, said):
    """Instead of a mission that is another one."""
    with pytest.raises(BenchError, match=said):
        made(text)
