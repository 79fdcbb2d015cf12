"""Tries whether replies of a mirror session get their source info, before anybody relies on it."""

import time

import zenoh

from proxy import clock
from proxy.bridge.declarations.source_info import enclosed, encoded
from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.keys import PREFIX


def gives_source(main: zenoh.Session, mirror: zenoh.Session, mark: bytes) -> bool:
    """Whether `main` finds replies of its `mirror` session as `enclosed` has them: a delete, and others of any size."""
    info = zenoh.SourceInfo(mirror.id, 2**32 - 1)
    asked = f"{PREFIX}/trial/{mirror.zid()}/*"
    key = asked[:-1].ljust(TUNING.key_and_encoding + TUNING.before_mark, "x")
    sent = ((b"", b"a"), (bytes(TUNING.trial_payload), None))

    def answer(query: zenoh.Query) -> None:
        with query:
            for payload, attachment in sent:
                own = enclosed(mark, info, attachment)
                query.reply(key, payload, attachment=own)
            query.reply_del(key, attachment=enclosed(mark, info, b"d"))

    expected = [(*each, encoded(info)) for each in (*sent, (b"", b"d"))]
    served = mirror.declare_queryable(asked, zenoh.handlers.Callback(answer))
    try:
        return _answers(main, asked, len(expected)) == expected
    finally:
        served.undeclare()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs


def _answers(main: zenoh.Session, asked: str, count: int) -> list[tuple[bytes, bytes | None, bytes | None]]:
    """Ask until `count` answers come: a queryable that is just declared may not be reached yet."""
    end = clock.monotonic() + TUNING.trial_timeout
    while True:
        replies = main.get(
            asked,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=TUNING.trial_timeout,
            allowed_destination=zenoh.Locality.REMOTE,
        )
        found = [_plain(reply.ok) for reply in replies if reply.ok is not None]
        if len(found) == count or clock.monotonic() > end:
            return found
        time.sleep(TUNING.trial_pause)


def _plain(sample: zenoh.Sample) -> tuple[bytes, bytes | None, bytes | None]:
    attachment, info = sample.attachment, sample.source_info
    return (
        bytes(sample.payload),
        None if attachment is None else bytes(attachment),
        None if info is None else encoded(info),
    )
