"""Robots that broadcast: one transmission of a sample reaches all of them."""

import time

import pytest

from tests.system.test_namespaces import assert_conserved
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SIZE = 40_000
"""Of a sample [B]."""


@pytest.mark.parametrize(("names", "transport", "copies"), [("abc", "broadcast", 1), ("abc", "unicast", 2), ("abcdefg", "broadcast", 1)])
def test_one_transmission_reaches_all(team, names, transport, copies):
    """A sample is on the air once however many robots hear it; in unicast once for each of them."""
    speaking, *hearing = team(names, transport=transport)
    listeners = [robot.hear("bulk") for robot in hearing]
    wait_until(lambda: speaking.status()["daemon"]["wanted"] is not None, what="x")
    warm = speaking.say("bulk", size=SIZE, rate=10)
    wait_until(lambda: all(listener.numbers("bulk") for listener in listeners), what="a sample everywhere")
    began, before = [len(l.numbers("bulk")) for l in listeners], sum(r.host.sent() for r in (speaking, *hearing))
    time.sleep(3)
    after = sum(r.host.sent() for r in (speaking, *hearing))
    n = [len(l.numbers("bulk"))-b for l, b in zip(listeners, began)]
    print("SAMPLES", n, "per sample", (after-before)/max(n), "copies", (after-before)/max(n)/SIZE)
