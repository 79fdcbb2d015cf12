"""Reads a request for the metrics and makes the answer: as much of HTTP/1.0 as that takes, bytes in, bytes out.

Python's own server brings OpenSSL, and all that reads mail: 6 MB of a daemon.
"""

import time
from collections.abc import Callable

PATH = "/metrics"
FORMAT = "text/plain; version=0.0.4; charset=utf-8"
"""The format that every Prometheus reads."""
LARGEST = 16_384
"""The largest head of a request [B]."""
_ALLOWED = "GET, HEAD"
_PLAIN = "text/plain; charset=utf-8"


def is_whole(head: bytes) -> bool:
    """Whether an empty line ends the head of a request; lines may end as they like."""
    return b"\r\n\r\n" in head or b"\n\n" in head


def answer(head: bytes, now: float, page: Callable[[], bytes]) -> bytes:
    """Return the answer to a request at a wall time [s]; nothing if nothing was said.

    `page` makes the metrics; where it raises TimeoutError the answer says that the daemon is busy.
    """
    if not head.strip():
        return b""
    refusal, kind, text = _refusal(head), FORMAT, b""
    if not refusal:
        try:
            text = page()
        except TimeoutError:
            refusal = "503 The daemon is busy"
    if refusal:
        kind, text = _PLAIN, f"{refusal.partition(' ')[2]}\n".encode()
    date = time.strftime("%a, %d %b %Y %H:%M:%S GMT", time.gmtime(now))  # Python's own names, of no language
    fields = f"Date: {date}\r\nContent-Type: {kind}\r\nContent-Length: {len(text)}\r\nAllow: {_ALLOWED}\r\n"
    told = f"HTTP/1.0 {refusal or '200 OK'}\r\nServer: sendworthy\r\n{fields}Connection: close\r\n\r\n".encode()
    return told if head.startswith(b"HEAD ") else told + text


def _refusal(head: bytes) -> str:
    """Return why this gets no metrics, behind the number that HTTP has for it; nothing if it does."""
    words = head.partition(b"\n")[0].split()
    if not is_whole(head):
        return "431 The request is too large" if len(head) >= LARGEST else "400 This is no request"
    if len(words) != 3 or not words[2].startswith(b"HTTP/1."):
        return "400 This is no request"
    if words[0].decode("latin-1") not in _ALLOWED.split(", "):
        return "405 The metrics can only be read"
    return "" if words[1].partition(b"?")[0] == PATH.encode() else f"404 The metrics are at {PATH}"
