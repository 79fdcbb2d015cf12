"""Tries whether replies of a voice get their source info, before anybody relies on it."""

import time

import zenoh

from proxy import clock
from proxy.bridge.keys import PREFIX
from proxy.bridge.sourcing import MOST_BEFORE, ROOM, enclosed, encoded

PATIENCE = 2.0
"""How long a query of a main session to its voice may take [s]; it takes some milliseconds."""
_PAUSE = 0.002
"""Time between two attempts [s]."""
_LARGE = 65536
"""A payload that goes in fragments [B]."""


def gives_source(main: zenoh.Session, voice: zenoh.Session, mark: bytes) -> bool:
    """Whether `main` finds replies of its `voice` as `enclosed` has them: a delete, and others of any size."""
    info = zenoh.SourceInfo(voice.id, 2**32 - 1)
    asked = f"{PREFIX}/trial/{voice.zid()}/*"
    key = asked[:-1].ljust(MOST_BEFORE + ROOM, "x")
    sent = ((b"", b"a"), (bytes(_LARGE), None))

    def answer(query: zenoh.Query) -> None:
        with query:
            for payload, attachment in sent:
                own = enclosed(mark, info, attachment)
                query.reply(key, payload, attachment=own)
            query.reply_del(key, attachment=enclosed(mark, info, b"d"))

    expected = [(*each, encoded(info)) for each in (*sent, (b"", b"d"))]
    served = voice.declare_queryable(asked, zenoh.handlers.Callback(answer))
    try:
        return _answers(main, asked, len(expected)) == expected
    finally:
        served.undeclare()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs


def _answers(main: zenoh.Session, asked: str, count: int) -> list[tuple[bytes, bytes | None, bytes | None]]:
    """Ask until `count` answers come: a queryable that is just declared may not be reached yet."""
    end = clock.monotonic() + PATIENCE
    while True:
        replies = main.get(
            asked,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=PATIENCE,
            allowed_destination=zenoh.Locality.REMOTE,
        )
        found = [_plain(reply.ok) for reply in replies if reply.ok is not None]
        if len(found) == count or clock.monotonic() > end:
            return found
        time.sleep(_PAUSE)


def _plain(sample: zenoh.Sample) -> tuple[bytes, bytes | None, bytes | None]:
    attachment, info = sample.attachment, sample.source_info
    return (
        bytes(sample.payload),
        None if attachment is None else bytes(attachment),
        None if info is None else encoded(info),
    )
