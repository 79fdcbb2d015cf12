"""An unmodified Zenoh application of a robot, as a program: it knows localhost:7447 and nothing else.

With `SETTING=FILE` in front of these words its configuration is that file, with `SETTING=default` Zenoh's default, with
`SETTING=environment` what the environment names.

    python application.py hear KEY                   a line of JSON for each sample: number, source, times
    python application.py say KEY SIZE RATE [block]  numbered samples of SIZE bytes, RATE a second, until standard input
                                                     ends; then two lines of JSON: how late one was at most, how many

Both print when they are ready first. Times are those of the machine's monotonic clock [s], which all namespaces share.
"""

import json
import select
import struct
import sys
import time

import zenoh

ROUTER = "tcp/127.0.0.1:7447"
HEAD = struct.Struct("<Qd")


def main():
    """Do what the command line says."""
    words = sys.argv[1:]
    setting = words.pop(0).removeprefix("SETTING=") if words[0].startswith("SETTING=") else None
    role, key, *rest = words
    with zenoh.open(configuration(setting)) as session:
        if role == "hear":
            hear(session, key)
        else:
            say(session, key, int(rest[0]), float(rest[1]), block="block" in rest)


def configuration(setting):
    """The configuration of the application."""
    if setting == "default":
        return zenoh.Config()
    if setting == "environment":
        return zenoh.Config.from_env()
    if setting:
        return zenoh.Config.from_file(setting)
    options = {"mode": "client", "connect": {"endpoints": [ROUTER], "timeout_ms": 10_000}}
    return zenoh.Config.from_json5(json.dumps(options))


def hear(session, key):
    """Print what is heard until standard input ends."""

    def take(sample):
        number, sent = HEAD.unpack(bytes(sample.payload)[: HEAD.size])
        tell({"key": str(sample.key_expr), "number": number, "sent": sent, "heard": time.monotonic()})

    asked = time.monotonic()
    subscriber = session.declare_subscriber(key, zenoh.handlers.Callback(take, indirect=False))
    tell({"asked": asked})
    sys.stdin.read()
    subscriber.undeclare()


def say(session, key, size, rate, *, block):
    """Publish until standard input ends."""
    control = zenoh.CongestionControl.BLOCK if block else zenoh.CongestionControl.DROP
    publisher = session.declare_publisher(key, congestion_control=control)
    tell("ready")
    number, due, late = 0, time.monotonic(), 0.0
    while not select.select([sys.stdin], [], [], max(0.0, due - time.monotonic()))[0]:
        late = max(late, time.monotonic() - due)
        publisher.put(HEAD.pack(number, time.monotonic()).ljust(size, b"\0"))
        number, due = number + 1, due + 1 / rate
    tell({"late": late})
    tell(number)


def tell(message):
    """Print a line of JSON at once."""
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
