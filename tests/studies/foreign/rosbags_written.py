"""ROS 2 bags for tests."""

from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer

from tests.utility_specs.features.test_cdr import BATTERY, STORE, battery, packed, scan

BEGIN = 1_700_000_000_000_000_000
"""When the first message was recorded [ns]."""
POINT = "geometry_msgs/msg/Point"
TOPICS = {
    "/r1/battery": (BATTERY, lambda i: battery(1.0 - i / 100)),
    "/r2/lidar/scan": ("sensor_msgs/msg/LaserScan", lambda _: scan()),
    "/point": (POINT, lambda i: packed(POINT, float(i), 0.0, 0.0)),
}


def write_bag(path, storage="mcap", messages=30):
    """Write a bag with so many messages on each of three topics, 0.1 s apart."""
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        topics = [(writer.add_connection(t, kind, typestore=STORE), made) for t, (kind, made) in TOPICS.items()]
        for i in range(messages):
            for connection, made in topics:
                writer.write(connection, BEGIN + i * 100_000_000, made(i))
    return path


def write_mcap(path, *, profile="ros2", **how):
    """Write 200 messages of two topics, 1 s apart, as others do; return how large the file is [B]."""
    with path.open("wb") as file:
        writer = McapWriter(file, **how)
        writer.start(profile)
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        topics = [writer.register_channel(f"/r1/{name}", "cdr", schema) for name in ("a", "b")]
        for i in range(200):
            writer.add_message(topics[i % 2], BEGIN + i * 10**9, bytes([i]) * 50, BEGIN + i * 10**9)
        writer.finish()
    return path.stat().st_size


def write_small_chunks(path):
    """Write a bag that a recorder left behind which was killed, but for its end: a folder with one file."""
    path.mkdir()
    write_mcap(path / "bag_0.mcap", chunk_size=1000)
    return path
