"""What is answered to a request."""

from email.utils import parsedate_to_datetime
from http.client import HTTPResponse
from io import BytesIO

import pytest

from proxy.metrics.request import FORMAT, LARGEST, answer, is_whole

NOW = 1_000_000_000.5
PAGE = b"sendworthy_up 1\n"


class Wire:
    """What Python's own client reads from."""

    def __init__(self, data):
        self._data = data

    def makefile(self, _mode):
        return BytesIO(self._data)


def told(head, page=lambda: PAGE, method="GET"):
    """Return an answer as Python's own client reads it, and its body."""
    response = HTTPResponse(Wire(answer(head, NOW, page)), method=method)
    response.begin()
    return response, response.read()


@pytest.mark.parametrize(
    "head",
    [b"GET /metrics HTTP/1.1\r\nHost: r1\r\n\r\n", b"GET /metrics?a=b HTTP/1.0\n\n", b"GET /metrics HTTP/1.9\n\n"],
)
def test_who_asks_gets_the_metrics(head):
    """With their format, their length and the time."""
    response, text = told(head)
    assert (response.status, text, response.headers["Content-Type"]) == (200, PAGE, FORMAT)
    assert int(response.headers["Content-Length"]) == len(PAGE)
    assert parsedate_to_datetime(response.headers["Date"]).timestamp() == int(NOW)


def test_who_asks_for_the_head_gets_nothing_else():
    """As the protocol has it."""
    response, text = told(b"HEAD /metrics HTTP/1.1\r\n\r\n", method="HEAD")
    assert (response.status, response.headers["Content-Length"], text) == (200, str(len(PAGE)), b"")
    assert answer(b"HEAD /metrics HTTP/1.1\r\n\r\n", NOW, lambda: PAGE).endswith(b"\r\n\r\n")


@pytest.mark.parametrize(
    ("head", "code", "why"),
    [
        (b"GET / HTTP/1.1\r\n\r\n", 404, "The metrics are at /metrics"),
        (b"GET /metrics/x HTTP/1.1\r\n\r\n", 404, "The metrics are at /metrics"),
        (b"POST /metrics HTTP/1.1\r\n\r\nabc", 405, "The metrics can only be read"),
        (b"GET /metrics\r\n\r\n", 400, "This is no request"),
        (b"GET /metrics HTTP/1.1\r\n", 400, "This is no request"),
        (b"GET /metrics HTTP/9.9\r\n\r\n", 400, "This is no request"),
        (b"\x16\x03\x01\x00\xa5\x01 \x00\r\n\r\n", 400, "This is no request"),
        (b"GET /" + b"a" * LARGEST, 431, "The request is too large"),
    ],
)
def test_what_cannot_be_answered_is_refused_with_a_reason(head, code, why):
    """Nothing of the request is in the answer, and no metrics are read for it."""
    response, text = told(head, page=pytest.fail)
    assert (response.status, response.reason, text) == (code, why, f"{why}\n".encode())


def test_a_daemon_that_is_busy_says_so():
    """So that the scrape counts as failed."""

    def busy():
        raise TimeoutError

    assert told(b"GET /metrics HTTP/1.1\r\n\r\n", busy)[0].status == 503


def test_who_says_nothing_is_told_nothing():
    """Somebody looked whether the port is open."""
    assert answer(b"", NOW, pytest.fail) == answer(b"\r\n\r\n", NOW, pytest.fail) == b""


@pytest.mark.parametrize(("head", "whole"), [(b"a\r\n\r\n", True), (b"a\n\n", True), (b"a\r\n", False), (b"", False)])
def test_an_empty_line_ends_a_request(head, whole):
    """However its lines end."""
    assert is_whole(head) is whole
