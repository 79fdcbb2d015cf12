"""ROS 2 bags for tests."""

from rosbags.rosbag2 import StoragePlugin, Writer

from tests.utility_specs.features.test_cdr import BATTERY, STORE, battery, packed, scan

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
                writer.write(connection, 1_700_000_000_000_000_000 + i * 100_000_000, made(i))
    return path
