"""Traffic from ROS 2 bags: rosbag2, as MCAP or sqlite3, a folder or a single file. Needs rosbags, the extra `ros2`.

Keys are those that `rmw_zenoh` gives topics, so that specs for a robot hold for its bags:
`<domain>/<topic>/<type>/<hash of the type>`. A message's time is when it was recorded.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from studies.foreign.arrived import Arrived
from studies.foreign.csv_files import is_key
from studies.foreign.cut_bags import CutFile, files_of
from studies.foreign.errors import ImportFailedError

UNKNOWN_HASH = "TypeHashNotSupported"
"""What stands in keys where the hash of a type is not known."""
DISTRO = Stores.ROS2_JAZZY
"""Whose types are known by name, where a bag does not define its own."""


@dataclass(slots=True)
class Bag:
    """A bag of one robot; with `by_namespace` each topic belongs to the robot that its first word names.

    `plain_keys`: keys are topics without the leading slash. What could not be read is told in `problems`.
    """

    path: Path
    robot: str
    by_namespace: bool = False
    plain_keys: bool = False
    domain: int = 0
    problems: list[str] = field(default_factory=list)

    def samples(self) -> Iterator[Arrived]:
        """Yield its messages in order, read one after the other. Raises ImportFailedError or OSError."""
        try:
            reader = Reader(self.path)
            reader.open()
        except PermissionError:
            raise
        except FileNotFoundError as error:
            yield from self._cut(self._lacks(error))
            return
        except Exception as error:  # noqa: BLE001 - a broken file makes rosbags fail in any way
            yield from self._cut(f"{self.path} is no ROS 2 bag that can be read: {_worded(error)}")
            return
        try:
            yield from self._messages(reader)
        finally:
            reader.close()

    def _cut(self, refusal: str) -> Iterator[Arrived]:
        """Yield the messages of a bag that rosbags refuses. Raises ImportFailedError where none can be read."""
        files = [CutFile(path) for path in files_of(self.path)] if self.path.exists() else []
        yield from self._arrived(chain.from_iterable(each.messages() for each in files))
        total = sum(each.count for each in files)
        if not total:
            raise ImportFailedError(refusal)
        self.problems += [each.problem for each in files if each.problem] or [
            f"{refusal.rstrip('.')}; its files hold {total:,} messages all the same"
        ]

    def _lacks(self, error: FileNotFoundError) -> str:
        if not self.path.exists():
            return f"{self.path} does not exist"
        if self.path.is_dir():
            return f"{self.path} is no whole bag: metadata.yaml is not in it"
        return f"{self.path}: {_worded(error)}"

    def _messages(self, reader: Reader) -> Iterator[Arrived]:
        count = 0
        for arrived in self._arrived(self._undamaged(reader)):
            count += 1
            yield arrived
        if 0 < count < reader.message_count:
            self.problems.append(f"{self.path}: only {count:,} of {reader.message_count:,} messages could be read")
        if not count:
            raise ImportFailedError(f"{self.path} holds no message" if not self.problems else self.problems.pop())

    def _undamaged(self, reader: Reader) -> Iterator[tuple[Any, int, bytes]]:
        """Yield what can be read."""
        messages = iter(reader.messages())
        while True:
            try:
                message = next(messages)
            except StopIteration:
                return
            except Exception as error:  # noqa: BLE001 - as above
                self.problems.append(f"{self.path} is damaged: {_worded(error)}")
                return
            yield message

    def _arrived(self, messages: Iterable[tuple[Any, int, bytes]]) -> Iterator[Arrived]:
        named: dict[tuple[str, str], tuple[str, str]] = {}
        last = -1
        for connection, at, data in messages:
            place = connection.topic, connection.msgtype
            if place not in named:
                named[place] = self._named(connection)
            robot, key = named[place]
            last = max(last, at)
            yield Arrived(last / 1e9, robot, key, len(data), payload=bytes(data))

    def _named(self, connection: Any) -> tuple[str, str]:
        """Return the robot and the key of a topic."""
        topic = connection.topic.strip("/")
        robot = topic.split("/", 1)[0] if self.by_namespace and "/" in topic else self.robot
        key = topic if self.plain_keys else f"{self.domain}/{topic}/{_type(connection.msgtype)}/{_hash(connection)}"
        if not is_key(key):
            raise ImportFailedError(f'{self.path}: the topic "{connection.topic}" makes no key of Zenoh')
        return robot, key


def _type(name: str) -> str:
    """Return a type as DDS names it: sensor_msgs::msg::dds_::Imu_."""
    *package, last = name.split("/")
    return "::".join([*package, "dds_", f"{last}_"])


def _hash(connection: Any) -> str:
    if connection.digest:
        return str(connection.digest)
    store = get_typestore(DISTRO)
    return store.hash_rihs01(connection.msgtype) if connection.msgtype in store.fielddefs else UNKNOWN_HASH


def _worded(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
