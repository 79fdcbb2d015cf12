"""Recordings and events for tests."""

from proxy.core.interface import events as ev
from proxy.core.model.settings import CoreSettings
from proxy.recording.entries import Start
from proxy.recording.reading import RecordingReader
from proxy.recording.writing import RecordingWriter

START = Start("robot", robot="r1", zid="z1", whole=True, now=1.0, settings=CoreSettings("r1", "z1"), wall_offset=1.7e9)


def published(number, *, now=None, **features):
    """Sample `number` of a stream."""
    at = 1.0 + number * 0.01 if now is None else now
    return ev.SamplePublished(at, number, "robot/r1/camera", 1000, at - 1e-3, None, 5, features)


def recorded(path, events=10, start=START, chunks=1):
    """Write a recording of so many samples in so many chunks, and return its path."""
    with RecordingWriter(path, start) as writer:
        for number in range(events):
            writer.happened(published(number, red=1 / (number + 3)))
            if (number + 1) % max(1, events // chunks) == 0:
                writer.flush()
    return path


def entries(path):
    """Return what stands in a recording, and what was wrong with it."""
    reader = RecordingReader(path)
    return list(reader), reader.problems
