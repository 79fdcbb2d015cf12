"""Who may ask the page's server what: a browser that has the page open, and to change anything, with its token.

Browsers let any page of the web send requests to this machine. So a request must name this server as its host (else a
name of somebody else's may have been pointed at us), must not come from another origin, and what changes robots must
bring the token in a header, which no other origin can send along without our leave, and we give none (no CORS).
"""

import ipaddress
import json
import re
import secrets
from collections.abc import Collection

from starlette.types import ASGIApp, Message, Receive, Scope, Send

TOKEN = b"x-sendworthy-token"
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = tuple(
    (name.encode(), value.encode())
    for name, value in {
        "content-security-policy": POLICY,
        "x-content-type-options": "nosniff",
        "x-frame-options": "DENY",
        "referrer-policy": "no-referrer",
        "cross-origin-resource-policy": "same-origin",
        "cross-origin-opener-policy": "same-origin",
        "cache-control": "no-store",
    }.items()
)
LOCAL = "localhost"
HOST = re.compile(r"(?P<name>\[[^]]*\]|[^:]*)(:[0-9]+)?")


def new_token() -> str:
    """Return a token that nobody guesses."""
    return secrets.token_urlsafe(24)


class Guard:
    """Lets through to `app` what may ask; `names` are those that this server has besides its addresses."""

    def __init__(self, app: ASGIApp, token: str, names: Collection[str] = ()) -> None:
        self._app = app
        self._token = token.encode()
        self._names = {LOCAL, *(name.lower() for name in names)}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope["method"], scope["headers"])
        if refusal is None:
            await self._app(scope, receive, _with_headers(send))
        else:
            await _refuse(*refusal, _with_headers(send))

    def _refusal(self, method: str, headers: list[tuple[bytes, bytes]]) -> tuple[int, str] | None:
        """Return why a request is refused, with the status for it."""
        hosts = _all(headers, b"host")
        if len(hosts) != 1 or not self._is_ours(hosts[0]):
            return 421, "this server has no such name; start `sendworthy page` with --name if it shall"
        ours = f"http://{hosts[0]}", f"https://{hosts[0]}"
        if not _from_here(headers) or any(origin not in ours for origin in _all(headers, b"origin")):
            return 403, "pages of other origins have no business here"
        if method not in ("GET", "HEAD", "POST"):
            return 405, "only GET and POST"
        given = b"".join(value for name, value in headers if name == TOKEN)
        if method == "POST" and not secrets.compare_digest(given, self._token):
            return 403, "to change anything, open the address that `sendworthy page` printed, with its token"
        return None

    def _is_ours(self, host: str) -> bool:
        """Whether a host is an address, which nobody can point at us, or one of our names."""
        parts = HOST.fullmatch(host)
        if parts is None:
            return False
        if parts["name"].lower() in self._names:
            return True
        try:
            ipaddress.ip_address(parts["name"].strip("[]"))
        except ValueError:
            return False
        return True


def _all(headers: list[tuple[bytes, bytes]], wanted: bytes) -> list[str]:
    return [value.decode("latin-1") for name, value in headers if name == wanted]


def _from_here(headers: list[tuple[bytes, bytes]]) -> bool:
    """Whether our own page asks, or somebody opens it: browsers tell, other programs need not."""
    site, how = _all(headers, b"sec-fetch-site"), _all(headers, b"sec-fetch-mode")
    return not site or site[0] in ("same-origin", "none") or how == ["navigate"]


async def _refuse(status: int, why: str, send: Send) -> None:
    body = json.dumps({"problem": why}).encode()
    head = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": status, "headers": head})
    await send({"type": "http.response.body", "body": body})


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message.get("headers", ()), *HEADERS]
        await send(message)

    return sending
