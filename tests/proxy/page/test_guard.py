"""Who may ask the page's server what; asked as browsers and others do, of the server as it runs."""

import http.client
import json

import pytest

from tests.pages import Served
from tests.ports import free_port


@pytest.fixture(scope="module")
def page():
    """A page without a daemon, which is enough for who may ask."""
    served = Served("--connect", f"tcp/127.0.0.1:{free_port()}", "--name", "Ground.local")
    yield served
    served.end()


def test_what_comes_is_guarded_by_headers(page):
    """Nothing from elsewhere may run in the page, nobody may frame it, and nobody else may read it."""
    for path in ("/", "/page.js", "/page.css", "/icon.svg", "/specs", "/nothing"):
        status, headers, _ = page.ask("GET", path)
        assert status == (404 if path == "/nothing" else 200)
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert headers["Cache-Control"] == "no-store"
        assert headers["Access-Control-Allow-Origin"] is None


@pytest.mark.full
@pytest.mark.parametrize(
    "host",
    [
        *("evil.example", "127.0.0.1.evil.example:80", "localhost.evil", "", "[::1", "127.1"),
        *("localhost:1@evil.example", "127.0.0.1:x", "[::1]evil.example", "[::1]:1@evil.example"),
    ],
)
def test_a_name_that_is_not_ours_is_refused(page, host):
    """Somebody may have pointed it at this machine (DNS rebinding)."""
    status, _, body = page.ask("GET", "/", Host=host)
    assert status == 421
    assert "this server has no such name" in json.loads(body)["problem"]


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:1", "192.168.1.7:7448", "[::1]:7448", "ground.LOCAL:80"])
def test_addresses_and_our_names_are_ours(page, host):
    """Nobody can point an address elsewhere."""
    assert page.ask("GET", "/", Host=host)[0] == 200


def test_two_hosts_are_none(page):
    """Who reads the one and who the other is not to be guessed."""
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=30)
    connection.putrequest("GET", "/", skip_host=True)
    connection.putheader("Host", "127.0.0.1")
    connection.putheader("Host", "evil.example")
    connection.endheaders()
    assert connection.getresponse().status in (400, 421)
    connection.close()


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "no-cors"},
        {"Sec_Fetch_Site": "same-site", "Sec_Fetch_Mode": "cors"},
    ],
)
def test_pages_of_other_origins_are_refused(page, headers):
    """Whether they read or change, and even if they had the token."""
    for method, path, told in (("GET", "/live", None), ("GET", "/specs", None), ("POST", "/filter", {"filter": "off"})):
        status, _, body = page.ask(method, path, told, **headers)
        assert (status, json.loads(body)) == (403, {"problem": "pages of other origins have no business here"})


def test_links_from_elsewhere_open_the_page(page):
    """A person who follows one asks for it."""
    assert page.ask("GET", "/", Sec_Fetch_Site="cross-site", Sec_Fetch_Mode="navigate")[0] == 200


@pytest.mark.parametrize("path", ["/filter", "/check", "/push", "/demo/channel", "/demo/red"])
def test_what_changes_robots_needs_the_token(page, path):
    """Without it, or with another one, nothing is looked at."""
    for token in ({}, {"X_Sendworthy_Token": ""}, {"X_Sendworthy_Token": page.token[:-1]}):
        status, _, body = page.ask("POST", path, **token)
        assert status == 403
        assert "with its token" in json.loads(body)["problem"]
    assert page.ask("POST", path, {}, Origin=f"http://127.0.0.1:{page.port}")[0] == 409


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "TRACE"])
def test_other_methods_are_refused(page, method):
    """So no other origin is ever allowed anything in advance, either."""
    assert page.ask(method, "/filter")[0] == 405


@pytest.mark.full
def test_each_start_has_another_token(page):
    """It stands behind #, which browsers keep to themselves."""
    other = Served("--connect", f"tcp/127.0.0.1:{free_port()}")
    assert other.end() == 130
    assert len(page.token) == len(other.token) == 32
    assert page.token != other.token
    assert page.printed.startswith(f"the page is at http://Ground.local:{page.port}/#token=")
