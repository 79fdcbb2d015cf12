"""Applications with all that Zenoh offers, as programs with the shipped client configuration.

    python service.py serve NAME   declares the token `alive/NAME`, answers `ask/NAME`, publishes numbers on `data/NAME`
    python service.py watch        a line of JSON for each sample, each token that comes or goes, each round of answers

Both print "ready" first and end with standard input.
"""

import json
import select
import sys
import time
from pathlib import Path

import zenoh

CLIENT = Path(__file__).parent.parent.parent / "deploy" / "apps" / "client.json5"
PERIOD = 0.05
"""Time between samples [s]."""
ASKS = 0.4
"""Time between questions [s]."""


def main():
    """Do what the command line says."""
    role, *rest = sys.argv[1:]
    with zenoh.open(zenoh.Config.from_file(CLIENT)) as session:
        if role == "serve":
            serve(session, *rest)
        else:
            watch(session)


def serve(session, name):
    """Be there until standard input ends."""
    born = time.time_ns()

    def answer(query):
        with query:
            query.reply(f"ask/{name}", str(born))

    token = session.liveliness().declare_token(f"alive/{name}")
    queryable = session.declare_queryable(f"ask/{name}", direct(answer), complete=True)
    tell("ready")
    number = 0
    while not select.select([sys.stdin], [], [], PERIOD)[0]:
        session.put(f"data/{name}", f"{born} {number}")
        number += 1
    for declared in (token, queryable):
        declared.undeclare()


def watch(session):
    """Print what comes until standard input ends."""

    def hear(sample):
        tell({"sample": sample.payload.to_string()})

    def notice(sample):
        tell({"token": str(sample.key_expr), "alive": sample.kind == zenoh.SampleKind.PUT})

    declared = [
        session.declare_subscriber("data/**", direct(hear)),
        session.liveliness().declare_subscriber("alive/**", direct(notice), history=True),
    ]
    tell("ready")
    while not select.select([sys.stdin], [], [], ASKS)[0]:
        replies = [reply.ok.payload.to_string() for reply in session.get("ask/**", timeout=2.0) if reply.ok]
        alive = [str(reply.ok.key_expr) for reply in session.liveliness().get("alive/**", timeout=2.0) if reply.ok]
        tell({"answers": replies, "tokens": alive})
    for each in declared:
        each.undeclare()


def direct(callback):
    """A callback without a thread of its own."""
    return zenoh.handlers.Callback(callback, indirect=False)


def tell(message):
    """Print a line of JSON at once."""
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
