"""A Zenoh router as it comes, for the runs without the filter: one per robot, linked through the medium."""

import argparse
import json
import time

import zenoh

from studies.demo import cue


def main() -> None:
    """Route until told to stop; ready when linked to `--others` other routers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--listen", action="append", required=True, help="endpoint for apps or for other routers")
    parser.add_argument("--connect", action="append", default=[], help="endpoint of another router")
    parser.add_argument("--others", type=int, required=True)
    downsample = "at most so many samples of a key a second leave it"
    parser.add_argument("--downsample", nargs=2, metavar=("KEY", "HZ"), help=downsample)
    arguments = parser.parse_args()
    stop = cue.stop_on_signal()
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", json.dumps(arguments.listen))
    config.insert_json5("connect/endpoints", json.dumps(arguments.connect))
    # Not as it comes, because robots are not on one machine: they neither share memory nor find each other by
    # multicast on localhost.
    config.insert_json5("transport/shared_memory/enabled", "false")
    config.insert_json5("scouting/multicast/enabled", "false")
    if arguments.downsample:
        key, frequency = arguments.downsample
        rule = {
            "id": "demo",
            "messages": ["put"],
            "flows": ["egress"],
            "rules": [{"key_expr": key, "freq": float(frequency)}],
        }
        config.insert_json5("downsampling", json.dumps([rule]))
    with zenoh.open(config) as session:
        while len(session.info.routers_zid()) < arguments.others and not stop.is_set():
            time.sleep(0.05)
        cue.ready()
        stop.wait()


if __name__ == "__main__":
    main()
