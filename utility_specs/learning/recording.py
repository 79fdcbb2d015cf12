"""Recordings of traffic: a file of MessagePack values, a header first and then one array for each sample.

    {"sendworthy": "recording", "version": 1, "robots": ["r1", "r2"]}
    [time, key, encoding, payload, attachment, origin]
    …

`time` is in seconds on a clock that goes on, `attachment` and `origin` are nil where there is none, and `robots` are
the names that are known of the team. A recording may end anywhere: whatever is whole counts.
"""

from collections.abc import Iterator, Sequence
from itertools import count
from typing import Any, BinaryIO

import msgpack

from utility_specs.learning.observed import Observed
from utility_specs.learning.toml_text import counted

VERSION = 1
LARGEST = 64 * 1024 * 1024
"""Bytes of the largest sample that is read."""
LATEST = 1e12
"""No clock shows more [s]."""


class RecordingError(Exception):
    """A file that is no recording, or one of another version."""


class Writer:
    """Writes a recording; `robots` are the names that are known of the team."""

    def __init__(self, file: BinaryIO, robots: Sequence[str] = ()) -> None:
        self._file = file
        self._write({"sendworthy": "recording", "version": VERSION, "robots": list(robots)})

    def add(self, sample: Observed) -> None:
        """Append a sample."""
        self._write(
            [sample.time, sample.key, sample.encoding, sample.payload, sample.attachment, sample.origin],
        )

    def _write(self, value: object) -> None:
        self._file.write(msgpack.packb(value, unicode_errors="surrogatepass"))


class Reader:
    """Reads a recording; iterating gives its samples, and afterwards `damage` says what could not be read.

    `robots` are the names that are known of the team. Raises RecordingError for what is no recording.
    """

    def __init__(self, file: BinaryIO) -> None:
        self.damage = ""
        self._file = file
        self._values = msgpack.Unpacker(
            file, max_buffer_size=LARGEST, strict_map_key=False, unicode_errors="surrogatepass"
        )
        self.robots = _robots_of(self._header())

    def __iter__(self) -> Iterator[Observed]:
        """Yield what is whole."""
        for number in count(1):
            end = self._values.tell()
            try:
                yield _sample_of(self._values.unpack())
            except msgpack.OutOfData:
                if self._file.tell() > end:
                    self.damage = f"the recording is cut off: {counted(number - 1, 'sample')} before that"
                return
            except (ValueError, msgpack.UnpackException) as error:
                self.damage = f"sample {number} cannot be read, nor what follows: {error}"
                return

    def _header(self) -> dict[Any, Any]:
        try:
            header = self._values.unpack()
        except (ValueError, msgpack.UnpackException):
            header = None
        if not isinstance(header, dict) or header.get("sendworthy") != "recording":
            raise RecordingError("is not a recording of `sendworthy learn --record`")
        if header.get("version") != VERSION:
            raise RecordingError(f"is a recording of version {header.get('version')}; this Sendworthy reads {VERSION}")
        return header


def _robots_of(header: dict[Any, Any]) -> tuple[str, ...]:
    robots = header.get("robots")
    return tuple(each for each in robots if isinstance(each, str)) if isinstance(robots, list) else ()


def _sample_of(value: object) -> Observed:
    """Return the sample that an array is; raises ValueError for anything else."""
    match value:
        case [float() | int() as time, str() as key, str() as encoding, bytes() as payload, attachment, origin, *_]:
            if abs(time) <= LATEST and isinstance(attachment, bytes | None) and isinstance(origin, str | None):
                return Observed(float(time), key, payload, encoding, attachment, origin)
    raise ValueError("it is not [time, key, encoding, payload, attachment, origin]")
