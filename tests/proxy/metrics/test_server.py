"""The metrics over HTTP: real sockets, and a real daemon."""

import errno
import logging
import socket
import urllib.error
import urllib.request
from functools import partial

import pytest
from prometheus_client.parser import text_string_to_metric_families

from proxy import exit_codes
from proxy.errors import MetricsError
from proxy.metrics import server as served
from proxy.metrics.request import LARGEST
from proxy.metrics.server import MetricsServer
from tests.daemons import Running
from tests.ports import free_port
from tests.proxy.metrics.statuses import status

GET = b"GET /metrics HTTP/1.1\r\nHost: robot\r\n\r\n"


@pytest.fixture
def address():
    return f"127.0.0.1:{free_port()}"


@pytest.fixture
def serve(stack, address):
    def start(read=status, listen=address):
        server = MetricsServer(listen, read)
        stack.callback(partial(server.close, 10.0))
        return server

    return start


def get(address, path="/metrics"):
    """Return the answer to a request as browsers make it."""
    with urllib.request.urlopen(f"http://{address}{path}", timeout=30) as answer:
        return answer.headers, answer.read().decode()


def asked(address, *parts):
    """Return what is answered to these bytes, all of it."""
    host, port = address.rsplit(":", 1)
    with socket.create_connection((host, int(port)), timeout=30) as connection:
        answer = b""
        try:
            for part in parts:
                connection.sendall(part)
            connection.shutdown(socket.SHUT_WR)
            while part := connection.recv(1 << 16):
                answer += part
        except (ConnectionResetError, BrokenPipeError):
            pass  # it did not read all of what we said
        except OSError as error:
            if error.errno != errno.ENOTCONN:  # shutting down what it has reset already
                raise
    return answer


def test_the_page_is_one_that_prometheus_reads(serve, address):
    """With its content type, and the metrics of the process beside ours."""
    serve()
    headers, text = get(address)
    assert headers["Content-Type"] == "text/plain; version=0.0.4; charset=utf-8"
    names = {family.name for family in text_string_to_metric_families(text)}
    assert {"sendworthy_mode", "sendworthy_samples_received", "process_resident_memory_bytes"} <= names


def test_a_request_may_come_in_parts(serve, address):
    """Lines may end as they like."""
    serve()
    assert asked(address, GET[:10], GET[10:]).startswith(b"HTTP/1.0 200 ")
    assert asked(address, b"GET /metrics?debug=1 HTTP/1.0\n\n").startswith(b"HTTP/1.0 200 ")


def test_there_is_nothing_else(serve, address):
    """Who asks for another page is told where the metrics are."""
    serve()
    with pytest.raises(urllib.error.HTTPError, match="404: The metrics are at /metrics"):
        get(address, "/")


BAD = (
    b"",
    b"\r\n\r\n",
    b"GET\r\n\r\n",
    b"POST /metrics HTTP/1.1\r\nContent-Length: 3\r\n\r\nabc",
    b"GET /metrics HTTP/9.9\r\n\r\n",
    b"GET /metrics HTTP/1.1\r\nAccept: text/plain; version=x\r\n\r\n",
    b"\x16\x03\x01\x00\xa5\x01\x00\x00\r\n\r\n",
    b"GET /metrics HTTP/1.1\r\n" + b"a: b\r\n" * LARGEST,
    b"GET /" + b"a" * 4 * LARGEST,
    bytes(range(256)) * 300,
)


def test_what_is_no_request_harms_nothing(serve, address, caplog):
    """Whatever was said, the next one is answered, and the log does not speak of it."""
    serve()
    with caplog.at_level(logging.INFO):
        for bad in BAD:
            assert b"Traceback" not in asked(address, bad)
        assert asked(address, GET).startswith(b"HTTP/1.0 200 ")
    assert not caplog.records


def test_who_dawdles_is_cut_off(serve, address, monkeypatch):
    """All threads are taken by connections that say nothing; the next one is answered all the same."""
    monkeypatch.setattr(served, "PATIENCE", 0.05)
    serve()
    host, port = address.split(":")
    dawdling = [socket.create_connection((host, int(port))) for _ in range(2 * served.THREADS)]
    assert asked(address, GET).startswith(b"HTTP/1.0 200 ")
    for connection in dawdling:
        connection.close()


def test_a_daemon_that_is_busy_says_so(serve, address):
    """Prometheus sees that the scrape failed."""

    def busy():
        raise TimeoutError

    serve(busy)
    with pytest.raises(urllib.error.HTTPError, match="503: The daemon is busy"):
        get(address)


def test_an_error_of_ours_is_logged_and_the_next_one_is_answered(serve, address, caplog):
    """A server that has died would be noticed by nobody."""
    answers = iter([{}, status()])
    serve(lambda: next(answers))
    assert asked(address, GET) == b""
    assert "was not answered" in caplog.text
    assert asked(address, GET).startswith(b"HTTP/1.0 200 ")


def test_want_of_file_descriptors_passes(serve, address, caplog, monkeypatch):
    """No connection can be accepted, and later one can."""
    monkeypatch.setattr(served, "PAUSE", 0.0)
    accept, failures = socket.socket.accept, iter([OSError(24, "Too many open files")])

    def scarce(self):
        for error in failures:
            raise error
        return accept(self)

    monkeypatch.setattr(socket.socket, "accept", scarce)
    serve()
    assert asked(address, GET).startswith(b"HTTP/1.0 200 ")
    assert "cannot accept a connection: Too many open files" in caplog.text


def test_after_the_end_nobody_answers_and_the_port_is_free(address):
    """Its threads are gone, too."""
    server = MetricsServer(address, status)
    server.close(10.0)
    assert not any(thread.is_alive() for thread in server._threads)
    MetricsServer(address, status).close(10.0)


def test_ipv6_is_served_where_there_is_any(serve):
    """The address is written as everywhere else."""
    listen = f"[::1]:{free_port()}"
    try:
        serve(listen=listen)
    except MetricsError as error:
        pytest.skip(str(error))
    assert get(listen)[1]


def test_a_port_that_is_taken_is_named_with_its_key(serve, address):
    """The operator knows which line to change."""
    serve()
    with pytest.raises(
        MetricsError, match=rf"metrics\.listen: nothing can listen on {address}: Address already in use"
    ):
        MetricsServer(address, status)


def test_a_daemon_serves_what_its_status_says(address):
    """The start says where."""
    daemon = Running("--robot", "r1", "--metrics.listen", address)
    try:
        assert daemon.wait_for("sendworthy ").rstrip().endswith(f", metrics on http://{address}/metrics")
        text = get(address)[1]
        values = {s.name: s for family in text_string_to_metric_families(text) for s in family.samples}
        assert values["sendworthy_build_info"].labels["version"] == daemon.status()["version"]
        assert values["sendworthy_build_info"].labels["robot"] == "r1"
        assert values["process_resident_memory_bytes"].value > 0
    finally:
        assert daemon.end() == exit_codes.OK


def test_a_daemon_that_cannot_serve_them_does_not_start(serve, address):
    """The exit code is that of a port in use, and nothing is left open."""
    serve()
    daemon = Running("--robot", "r1", "--metrics.listen", address)
    assert daemon.process.wait(60) == exit_codes.UNAVAILABLE
    daemon.end()
    assert "metrics.listen: nothing can listen on" in daemon.lines[-1]
