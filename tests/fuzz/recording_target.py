"""Recordings, fuzzed byte by byte: what somebody sends to be replayed or imported.

The first byte says what the rest is: a file, the messages of one, a snapshot of a core, or a file of others.
"""

import io
import struct
import tempfile
from contextlib import suppress
from itertools import islice
from pathlib import Path

from mcap.writer import CompressionType, Writer

from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.model.settings import CoreSettings
from proxy.recording.entries import PROFILE, Happened, Start
from proxy.recording.errors import RecordingError
from proxy.recording.json_data import plain, text
from proxy.recording.pickling import pickled
from proxy.recording.reading import RecordingReader
from proxy.recording.spec_parts import SpecParts
from proxy.recording.unpickling import unpickled
from proxy.recording.writing import RecordingWriter
from studies.foreign.bags import Bag
from studies.foreign.csv_files import Table
from studies.foreign.cut_bags import CutFile
from studies.foreign.errors import ImportFailedError
from studies.replay.errors import ReplayError
from studies.replay.recordings import Recordings
from studies.replay.same import SameReplay
from tests.fuzz.scratch import scratch
from tests.fuzz.target import messages, specs

KINDS = ("file", "messages", "snapshot", "bag.mcap", "bag.db3", "csv")
TOPICS = (
    *("start", "specs", "snapshot", "traffic", "gap", "end", "events/SamplePublished", "events/DigestHeard"),
    *("events/DecisionReady", "events/SpecsChanged", "events/StateHeard", "payloads/robot/r1/camera", "weather"),
)
START = Start("robot", robot="r1", zid="z1", whole=True, now=1.0, settings=CoreSettings("r1", "z1"), wall_offset=1.7e9)
MOST = 200
"""Entries that are looked at."""


def one_recording(data: bytes) -> None:
    """Read what there is, as replay and import do; raises only what is a fault."""
    kind, rest = KINDS[data[0] % len(KINDS) if data else 0], data[1:]
    match kind:
        case "file":
            _replayed(_written("a.mcap", rest))
        case "messages":
            _replayed(_written("a.mcap", _packed(messages(rest, TOPICS))))
        case "snapshot":
            with suppress(RecordingError):
                unpickled(rest, SpecParts(specs()))
        case "csv":
            with suppress(ImportFailedError):
                _all(Table(_written("a.csv", rest)).samples())
        case bag:
            path = _written(bag, rest)
            _all(CutFile(path).messages())
            with suppress(ImportFailedError):
                _all(Bag(path, "r1").samples())


def _replayed(path: Path) -> None:
    """Look at a recording as replay does."""
    try:
        reader = RecordingReader(path)
    except RecordingError:
        return
    for problem in reader.problems:
        assert str(path) in problem
    with suppress(ReplayError):
        found = Recordings([reader]).survey()
        _all(Recordings([reader]).told(found.samples))
    with suppress(RecordingError):
        same = SameReplay(reader.start)
        for entry in islice(reader, MOST):
            # A search of as many iterations as somebody says takes as long as these do.
            if isinstance(entry, Happened) and isinstance(entry.event, ev.DecisionReady):
                continue
            if not same.take(entry):
                break


def _all(things):
    return list(islice(things, MOST))


def _packed(messages):
    """Return a recording with these messages, as another program might write it."""
    file = io.BytesIO()
    writer = Writer(file, compression=CompressionType.NONE, use_statistics=False)
    writer.start(PROFILE)
    for number, (topic, data) in enumerate(messages):
        channel = writer.register_channel(topic, "json", 0, {"key": topic})
        writer.add_message(channel, 0, data, 0, number)
    writer.finish()
    return file.getvalue()


def message(topic, data):
    """The form of one message of the input."""
    return struct.pack(">BH", TOPICS.index(topic), len(data)) + data


def seeds():
    """Inputs that go deep, to start from."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.mcap"
        with RecordingWriter(path, START) as writer:
            for number in range(20):
                at = 1.0 + number * 0.01
                writer.happened(
                    ev.SamplePublished(at, number, "robot/r1/camera", 1000, at, None, 5, {"red": 1 / (number + 3)})
                )
        file = path.read_bytes()
    begin = message("start", text(plain(START)).encode())
    traffic = message("start", b'{"format": 1, "kind": "traffic"}')
    sample = message("traffic", b'{"robot": "r1", "key": "k", "t_gen": 1.0, "size": 10, "features": {"red": 0.5}}')
    told = [
        message("specs", b'{"generation": "x", "files": [{"name": "a.toml", "text": "version = 1"}]}'),
        message(
            "events/SamplePublished",
            b'{"now": 1.0, "sample": 1, "key": "robot/r1/camera", "size": 10, "t_gen": 1.0, "priority": 5,'
            b' "features": {}, "commands": [{"command": "Forward", "sample": 1, "reason": "sent"}]}',
        ),
        message("events/SpecsChanged", b'{"now": 2.0, "specs": "x"}'),
        message("gap", b'{"first": 2, "events": 3}'),
        message("payloads/robot/r1/camera", b"\xff\xd8"),
        message("end", b'{"number": 5, "reason": "done"}'),
    ]
    snapshot = pickled(Core(CoreSettings("r1", "z1"), specs(), 1.0))
    csv = b"t_gen,robot,key,size,red\n1.0,r1,robot/r1/camera,1000,0.5\n2.0,r2,robot/r2/camera,900,\n"
    bag = _packed([("start", b"1234")]).replace(PROFILE.encode(), b"ros2", 1)
    return {
        "file": b"\0" + file,
        "messages": b"\1" + begin + b"".join(told),
        "traffic": b"\1" + traffic + 3 * sample,
        "snapshot": b"\2" + snapshot,
        "bag": b"\3" + bag,
        "csv": b"\5" + csv,
    }


def _written(name: str, data: bytes) -> Path:
    path = scratch() / name
    path.write_bytes(data)
    return path
