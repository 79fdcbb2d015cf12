"""One clear line for an endpoint that cannot be reached, and one when it can."""

import socket
import threading
from itertools import count
from types import SimpleNamespace

import pytest

from proxy.bridge.links import Links, _resolved
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def test_an_unreachable_endpoint_is_said_once_and_again_when_linked(stack, caplog):
    """After its grace a missing link is one warning, however long it lasts; the link is one line too."""
    caplog.set_level("INFO")
    endpoint = free_endpoint()
    mesh = closing(stack, plain_session("peer", connect=()))
    links = Links(mesh, (endpoint,), 0.0)
    links.check(TUNING.link_grace / 2)
    assert not caplog.records
    assert links.warnings() == []
    for i in range(5):
        links.check(TUNING.link_grace + 1.0 + i)
    assert links.warnings() == [f"mesh.connect: no link to {endpoint}; still trying"]
    assert [record.message for record in caplog.records] == [f"mesh.connect: no link to {endpoint} yet; still trying"]
    closing(stack, plain_session("peer", listen=(endpoint,)))
    linked = closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_until(linked.info.links, what="the link")
    links._session = linked
    links.check(100.0)
    links.check(200.0)
    assert links.warnings() == []
    assert [record.levelname for record in caplog.records] == ["WARNING", "INFO"]
    assert links.describe()[0]["destination"] == endpoint


def test_nothing_is_said_without_endpoints(stack, caplog):
    """With scouting only there is nothing to miss."""
    Links(closing(stack, plain_session("peer")), (), 0.0).check(100.0)
    assert not [each for each in caplog.records if each.name == "proxy.bridge.links"]


@pytest.mark.parametrize(
    ("endpoint", "locator"),
    [
        ("tcp/127.0.0.1:7500", "tcp/127.0.0.1:7500"),
        ("tcp/localhost:7500#so_sndbuf=1", "tcp/127.0.0.1:7500"),
        ("tls/[::1]:7500", "tls/[::1]:7500"),
        ("tcp/no.such.host.invalid:1", "tcp/no.such.host.invalid:1"),
    ],
)
def test_endpoints_are_found_by_the_locators_of_links(endpoint, locator):
    """Names are resolved, options left out; a name that cannot be resolved stands for itself."""
    assert locator in _resolved(endpoint)


def test_a_name_that_takes_long_to_look_up_holds_nothing_up(monkeypatch, caplog):
    """Where no name server is in reach: the thread that looks after links mirrors what applications declare, too."""
    caplog.set_level("INFO")
    looked_up, names = threading.Event(), threading.Event()
    answer = [(socket.AF_INET, socket.SOCK_STREAM, 6, "", ("10.0.0.7", 7500))]

    def slow(*_, **__):
        looked_up.set()
        names.wait()
        return answer

    monkeypatch.setattr(socket, "getaddrinfo", slow)
    found = [SimpleNamespace(zid="z1", src="", dst="tcp/10.0.0.9:7500")]
    links = Links(SimpleNamespace(info=SimpleNamespace(links=lambda: found)), ("tcp/base.example:7500", "tcp/b:1"), 0.0)
    ticks = count(TUNING.link_grace + 1.0, TUNING.linked_check)
    links.check(next(ticks))
    assert looked_up.wait(30.0)
    links.check(next(ticks))
    assert links.warnings() == [
        f"mesh.connect: no link to tcp/{name}; still trying" for name in ("b:1", "base.example:7500")
    ]
    found[0].dst = "tcp/10.0.0.7:7500"
    names.set()
    wait_until(lambda: links.check(next(ticks)) or len(links.warnings()) == 1, what="the name that is known now")
    assert "mesh.connect: tcp/base.example:7500 is linked now" in caplog.messages


def test_links_are_listed_seldom_while_none_is_missing():
    """Zenoh has to list all of them; while one is missing it is asked more often."""
    found, asked = [SimpleNamespace(zid="z1", src="tcp/127.0.0.1:1", dst="tcp/127.0.0.1:2")], []

    def listed():
        asked.append(True)
        return found

    links = Links(SimpleNamespace(info=SimpleNamespace(links=listed)), ("tcp/127.0.0.1:2",), 0.0)
    for tick in range(17):
        links.check(tick / 4)
    assert len(asked) == 1 + 4.0 // TUNING.linked_check
    found.clear()
    for tick in range(24, 40):
        links.check(tick / 4)
    assert len(asked) == 1 + 4.0 // TUNING.linked_check + 4.0 // TUNING.missing_check
