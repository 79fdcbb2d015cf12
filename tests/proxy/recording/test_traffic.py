"""The traffic in a recording."""

from dataclasses import replace

from proxy.core.interface import events as ev
from proxy.recording.entries import Start, Traffic
from proxy.recording.reading import RecordingReader
from proxy.recording.traffic import traffic
from proxy.recording.writing import RecordingWriter
from tests.proxy.recording.lives import START, published

SAMPLE = Traffic("r2", "robot/r2/camera", 0.5, 1000, {"red": 0.25})


def test_mere_traffic_comes_as_it_is(tmp_path):
    """At wall times."""
    with RecordingWriter(tmp_path / "a.mcap", Start("traffic", source="a bag", wall_offset=100.0)) as writer:
        writer.traffic(SAMPLE)
    reader = RecordingReader(tmp_path / "a.mcap")
    assert reader.start.source == "a bag"
    assert list(traffic(reader.start, reader)) == [replace(SAMPLE, t_gen=100.5)]
    assert not reader.problems


def test_a_robot_s_traffic_is_what_its_apps_published(tmp_path):
    """Deletions and all other events are none."""
    sample = published(1, red=0.5)
    with RecordingWriter(tmp_path / "a.mcap", START) as writer:
        writer.happened(sample)
        writer.happened(ev.SampleHanded(1.0, 1))
        writer.happened(replace(sample, delete=True))
    reader = RecordingReader(tmp_path / "a.mcap")
    assert list(traffic(reader.start, reader)) == [
        Traffic("r1", sample.key, sample.t_gen + START.wall_offset, 1000, {"red": 0.5})
    ]


def test_much_traffic_goes_to_the_file_chunk_by_chunk(tmp_path):
    """So it takes no memory."""
    path = tmp_path / "a.mcap"
    with RecordingWriter(path, Start("traffic")) as writer:
        for number in range(5000):
            writer.traffic(replace(SAMPLE, t_gen=float(number)))
        assert path.stat().st_size > 1000
        assert writer.pending < 300_000
    reader = RecordingReader(path)
    assert [each.t_gen for each in traffic(reader.start, reader)] == [float(number) for number in range(5000)]
