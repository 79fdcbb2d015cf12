"""Tries whether replies of a voice get their source info, before anybody relies on it."""

import threading
from contextlib import ExitStack

import zenoh

from proxy.bridge.keys import PREFIX
from proxy.bridge.sourcing import MOST_BEFORE, ROOM, enclosed, encoded

PATIENCE = 2.0
"""How long a query of a main session to its voice may take [s]; it takes some milliseconds."""
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

    expected = [*((payload, attachment, _plain(info)) for payload, attachment in sent), (b"", b"d", _plain(info))]
    with ExitStack() as closing:
        served = voice.declare_queryable(asked, zenoh.handlers.Callback(answer))
        closing.callback(served.undeclare)
        return _answers(main, asked, closing) == expected


def _answers(main: zenoh.Session, key: str, closing: ExitStack) -> list[tuple[bytes, bytes | None, bytes | None]]:
    querier = main.declare_querier(
        key,
        consolidation=zenoh.ConsolidationMode.NONE,
        timeout=PATIENCE,
        allowed_destination=zenoh.Locality.REMOTE,
    )
    closing.callback(querier.undeclare)
    known = threading.Event()

    def tell(_: zenoh.MatchingStatus) -> None:
        known.set()

    querier.declare_matching_listener(zenoh.handlers.Callback(tell, indirect=False))
    status: object = querier.matching_status
    if not getattr(status, "matching", status):  # an object where the stubs promise a bool
        known.wait(PATIENCE)
    found = (reply.ok for reply in querier.get())
    return [
        (
            bytes(sample.payload),
            None if sample.attachment is None else bytes(sample.attachment),
            _plain(sample.source_info),
        )
        for sample in found
        if sample is not None
    ]


def _plain(info: zenoh.SourceInfo | None) -> bytes | None:
    return None if info is None else encoded(info)
