"""A Zenoh router as `zenohd` runs it by default, as a program.

    python router.py LISTEN [CONNECT…]

Everything is Zenoh's default but the endpoints; what `zenohd` switches on (the admin space) is on. It ends with its
standard input.
"""

import json
import sys

import zenoh


def main():
    """Route until standard input ends."""
    listen, *connect = sys.argv[1:]
    options = {
        "mode": "router",
        "listen": {"endpoints": listen.split(",")},
        "connect": {"endpoints": connect},
        "adminspace": {"enabled": True},
    }
    with zenoh.open(zenoh.Config.from_json5(json.dumps(options))):
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        sys.stdin.read()


if __name__ == "__main__":
    main()
