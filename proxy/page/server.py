"""Serves the page: one process, files that need no build, one stream for all that is live."""

import asyncio
import json
import logging
import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Collection
from contextlib import asynccontextmanager
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Receive, Scope, Send

from proxy.errors import PageError, ProxyError
from proxy.page.connections import Connection
from proxy.page.guard import Guard
from proxy.page.hub import Viewer
from proxy.page.orders import FILTERS, written
from proxy.page.page import Page
from proxy.page.specs import checked
from proxy.page.tuning import TUNING

STATIC = Path(__file__).parent / "static"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
Answer = Callable[[Page, bytes], dict[str, Any]]


def listening(listen: str) -> socket.socket:
    """Return a socket that listens on "HOST:PORT". Raises PageError when nothing can."""
    host, _, port = listen.rpartition(":")
    host = host.strip("[]")
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, int(port)), family=family)
    except OSError as error:
        raise PageError(f"nothing can listen on {listen}: {error.strerror}") from None


class Server(uvicorn.Server):
    """Serves `page` until a signal ends it; `names` are names of this machine besides its addresses."""

    def __init__(self, page: Page, token: str, names: Collection[str]) -> None:
        self._page = page
        super().__init__(
            uvicorn.Config(
                Guard(application(page), token, names),
                http=Connection,
                ws="none",
                lifespan="on",
                loop="asyncio",
                log_config=None,
                access_log=False,
                server_header=False,
                proxy_headers=False,
                limit_concurrency=4 * TUNING.viewers,
                timeout_graceful_shutdown=int(TUNING.linger),
            )
        )

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Let all who watch go first: uvicorn waits for them."""
        self._page.hub.close()
        # A browser that does not read is cut off, which uvicorn would tell with a traceback.
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        await super().shutdown(sockets)


def application(page: Page) -> ASGIApp:
    """Return the server's application; it starts the page and stops it."""

    @asynccontextmanager
    async def running(_: Starlette) -> AsyncIterator[None]:
        page.start()
        try:
            yield
        finally:
            await run_in_threadpool(page.stop)

    return Starlette(
        lifespan=running,
        routes=[
            *(Route(path, _file(file)) for path, file in _files().items()),
            Route("/live", Live(page)),
            Route("/specs", partial(_told, page), methods=["GET"]),
            Route("/why", partial(_why, page), methods=["GET"]),
            *(Route(path, _changing(page, answer), methods=["POST"]) for path, answer in CHANGES.items()),
        ],
    )


def _files() -> dict[str, Path]:
    return {"/": STATIC / "index.html"} | {f"/{file.name}": file for file in sorted(STATIC.iterdir()) if file.is_file()}


def _file(file: Path) -> Callable[[Request], Awaitable[Response]]:
    body, kind = file.read_bytes(), TYPES[file.suffix]

    async def answer(_: Request) -> Response:
        return Response(body, media_type=kind)

    return answer


async def _told(page: Page, _: Request) -> Response:
    return JSONResponse(page.specs())


async def _why(page: Page, request: Request) -> Response:
    robot, key = (request.query_params.get(name, "") for name in ("robot", "key"))
    return await _answered(lambda: {"text": page.orders.why(robot, key)})


def _changing(page: Page, answer: Answer) -> Callable[[Request], Awaitable[Response]]:
    """Return what answers a request that brings JSON; it waits for daemons on a thread of its own."""

    async def answering(request: Request) -> Response:
        body = b""
        try:
            async for part in request.stream():
                body += part
                if len(body) > TUNING.body_bytes:
                    return _problem(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "that is too much")
        except ClientDisconnect:
            return _problem(HTTPStatus.BAD_REQUEST, "nobody waits for an answer")
        return await _answered(partial(answer, page, body))

    return answering


async def _answered(answer: Callable[[], dict[str, Any]]) -> Response:
    try:
        return JSONResponse(await run_in_threadpool(answer))
    except ProxyError as error:
        return _problem(HTTPStatus.CONFLICT, str(error))


def _problem(status: HTTPStatus, what: str) -> Response:
    return JSONResponse({"problem": what}, status)


def _filter(page: Page, body: bytes) -> dict[str, Any]:
    name = str(_object(body).get("filter"))
    if name not in FILTERS:
        raise PageError(f"a filter is one of {', '.join(FILTERS)}")
    return {"outcomes": written(page.orders.filter(name))}


def _check(_: Page, body: bytes) -> dict[str, Any]:
    return checked(_spec_files(body))


def _push(page: Page, body: bytes) -> dict[str, Any]:
    found, outcomes = page.orders.specs(_spec_files(body))
    return {**found, "outcomes": written(outcomes)}


def _channel(page: Page, body: bytes) -> dict[str, Any]:
    return {"channel": page.orders.channel(body)}


def _red(page: Page, body: bytes) -> dict[str, Any]:
    return {"red": page.orders.red(body)}


CHANGES: dict[str, Answer] = {
    "/filter": _filter,
    "/check": _check,
    "/push": _push,
    "/demo/channel": _channel,
    "/demo/red": _red,
}
"""What needs the token. A check does, too: specs may name Python functions, which it imports."""


def _object(body: bytes) -> dict[str, Any]:
    """Read an object of JSON. Raises PageError."""
    try:
        told = json.loads(body)
    except (ValueError, RecursionError):
        told = None
    if not isinstance(told, dict):
        raise PageError("what was sent is no object of JSON")
    return told


def _spec_files(body: bytes) -> dict[str, str]:
    files = _object(body).get("files")
    if not isinstance(files, dict) or not all(isinstance(text, str) for text in files.values()):
        raise PageError('specs are sent as {"files": {"name.toml": "text"}}')
    return files


class Live:
    """Streams to a browser what is live, in the form of `frames.message`; to a slow one what is newest."""

    def __init__(self, page: Page) -> None:
        self._page = page

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send until the browser or the server goes."""
        if scope["method"] != "GET":  # a route for GET lets HEAD through, too
            await _problem(HTTPStatus.METHOD_NOT_ALLOWED, "only GET")(scope, receive, send)
            return
        viewer = self._page.hub.join()
        if viewer is None:
            await _problem(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are open")(scope, receive, send)
            return
        tasks = [asyncio.create_task(each) for each in (_gone(receive), _stream(viewer, send))]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._page.hub.leave(viewer)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)


async def _gone(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass


async def _stream(viewer: Viewer, send: Send) -> None:
    head = [(b"content-type", b"application/octet-stream")]
    await send({"type": "http.response.start", "status": HTTPStatus.OK, "headers": head})
    async for message in viewer.messages():
        await send({"type": "http.response.body", "body": message, "more_body": True})
    await send({"type": "http.response.body", "body": b""})
