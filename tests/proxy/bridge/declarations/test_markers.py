"""Markers between a main session and the one beside it."""

import threading
from collections import Counter
from dataclasses import replace
from functools import partial
from itertools import count

import pytest

from proxy.bridge import bounds
from proxy.bridge.declarations import markers as markers_module
from proxy.bridge.declarations.markers import Markers
from proxy.bridge.keys import marker
from tests.proxy.nodes import closing, free_endpoint, pass_fence, plain_session
from tests.waiting import wait_until


@pytest.fixture
def sessions(stack):
    """A main session, and one that is linked to it."""
    endpoint = free_endpoint()
    main = closing(stack, plain_session("router", listen=(endpoint,)))
    other = closing(stack, plain_session("client", connect=(endpoint,)))
    pass_fence(other, main)
    return main, other


@pytest.fixture
def markers(sessions):
    """Markers that both sessions hear."""
    main, other = sessions
    made = Markers(main, other, marker(str(main.zid())))
    pass_fence(other, main)
    yield made
    made.close()


@pytest.mark.parametrize("way", ["after_told", "after_taken"])
def test_the_job_of_each_marker_is_done_once(markers, way):
    """Either way; what one of them waits for is no business of another. One is lost now and then on a busy machine."""
    done: Counter[int] = Counter()
    sent = count()

    def send():
        getattr(markers, way)(partial(done.update, [next(sent)]))

    for _ in range(3):
        send()
    wait_until(lambda: len(done) >= 3 or send(), what="three markers")
    assert set(done.values()) == {1}


def test_what_others_publish_there_is_no_marker(sessions, markers):
    """They cannot know for what anybody waits."""
    main, other = sessions
    came = threading.Event()
    other.put(marker(str(main.zid())), b"forged")
    wait_until(lambda: came.is_set() or markers.after_taken(came.set), what="a marker")


def test_of_markers_that_are_lost_few_are_remembered(sessions, monkeypatch):
    """Here nobody hears any."""
    monkeypatch.setattr(markers_module, "BOUNDS", replace(bounds.BOUNDS, markers=2))
    main, other = sessions
    made = Markers(main, other, marker(str(main.zid())))
    made.close()
    done = []
    for number in range(5):
        made.after_told(lambda number=number: done.append(number))
    assert len(made._jobs) == 2
    again = Markers(main, other, marker(str(main.zid())))
    wait_until(lambda: again.after_taken(lambda: done.append("heard")) or done, what="a marker that is heard")
    again.close()
    assert set(done) == {"heard"}
