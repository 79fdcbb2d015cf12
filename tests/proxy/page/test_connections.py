"""Connections that ask nothing do not keep the places of those that do."""

import asyncio
import socket
from contextlib import asynccontextmanager

import pytest
import uvicorn
from uvicorn.server import ServerState

from proxy.page.connections import Connection
from proxy.page.tuning import PageTuning
from tests.pages import Served
from tests.ports import free_port
from tests.waiting import wait_until

HEAD = b"GET / HTTP/1.1\r\nHost: localhost\r\n"


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """A head may take half a second, and so may what is sent: a busy machine holds up our own for less."""
    monkeypatch.setattr("proxy.page.connections.TUNING", PageTuning(head=0.5, silent=0.5))


@asynccontextmanager
async def serving(answers):
    """Serve "done" on connections, each time when `answers`, a semaphore, lets one go; return what opens one."""

    async def app(_scope, _receive, send):
        await answers.acquire()
        await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"4")]})
        await send({"type": "http.response.body", "body": b"done"})

    config = uvicorn.Config(app, lifespan="off", log_config=None, timeout_keep_alive=3600)
    config.load()
    state = ServerState()
    server = await asyncio.get_running_loop().create_server(lambda: Connection(config, state, {}), "127.0.0.1", 0)
    writers = []

    async def opened():
        reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
        writers.append(writer)
        return reader, writer

    try:
        yield opened
    finally:
        for writer in writers:
            writer.close()
            await writer.wait_closed()
        server.close()


@pytest.mark.parametrize("said", [b"", b"GET", HEAD], ids=["nothing", "a word", "half a head"])
def test_who_sends_no_whole_head_is_closed(said):
    """However much of it came."""

    async def run():
        async with serving(asyncio.Semaphore(0)) as opened:
            reader, writer = await opened()
            writer.write(said)
            assert await asyncio.wait_for(reader.read(), 60.0) == b""

    asyncio.run(run())


def test_who_begins_another_request_and_stays_there_is_closed():
    """An answer before is no reason to wait for ever."""

    async def run():
        async with serving(asyncio.Semaphore(1)) as opened:
            reader, writer = await opened()
            writer.write(HEAD + b"\r\n" + HEAD)
            assert (await asyncio.wait_for(reader.read(), 60.0)).endswith(b"\r\n\r\ndone")

    asyncio.run(run())


def test_who_waits_for_an_answer_is_not_closed():
    """It may take longer than the head did; so may that of a request which came with the one before."""

    async def run():
        answers = asyncio.Semaphore(0)
        async with serving(answers) as opened:
            reader, writer = await opened()
            writer.write(2 * (HEAD + b"\r\n"))
            for _ in range(2):
                later, _ = await opened()
                assert await later.read() == b""  # its time is over, and so is that of the one before
                answers.release()
                await reader.readuntil(b"\r\n\r\n")
                assert await reader.readexactly(4) == b"done"

    asyncio.run(run())


def test_who_takes_nothing_is_closed():
    """A browser that is gone without a word takes as little as one that does not read."""

    async def run():
        async def app(_scope, _receive, send):
            await send({"type": "http.response.start", "status": 200, "headers": []})
            while True:
                await send({"type": "http.response.body", "body": bytes(1 << 20), "more_body": True})
                await asyncio.sleep(0.0)

        config = uvicorn.Config(app, lifespan="off", log_config=None)
        config.load()
        ended = asyncio.Event()

        class Noted(Connection):
            def connection_lost(self, exc):
                super().connection_lost(exc)
                ended.set()

        loop = asyncio.get_running_loop()
        server = await loop.create_server(lambda: Noted(config, ServerState(), {}), "127.0.0.1", 0)
        with socket.create_connection(server.sockets[0].getsockname()) as browser:
            browser.sendall(HEAD + b"\r\n")
            await asyncio.wait_for(ended.wait(), 60.0)
        server.close()

    asyncio.run(run())


@pytest.mark.full
def test_silent_connections_do_not_shut_out_browsers():
    """They take all places, but not for long."""
    page = Served("--connect", f"tcp/127.0.0.1:{free_port()}")
    silent = [socket.create_connection(("127.0.0.1", page.port)) for _ in range(64)]
    try:
        wait_until(lambda: page.ask("GET", "/")[0] == 200, what="room for a browser")
    finally:
        for connection in silent:
            connection.close()
        page.end()
