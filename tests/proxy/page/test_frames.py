"""Images that come from robots."""

import json
import struct
from functools import partial

import pytest
import zenoh

from proxy.page.frames import Delay, Frames
from proxy.page.tuning import TUNING
from tests.pages import image
from tests.proxy.nodes import closing, free_endpoint, pass_fence, plain_session
from tests.waiting import wait_until

JPEG = image(0)
PNG = b"\x89PNG and more"


@pytest.fixture
def shown(stack):
    """What is shown of what two apps publish, one of which stamps its samples; `publish` waits until all came."""
    where = free_endpoint()
    viewer = closing(stack, plain_session("peer", listen=(where,)))
    apps = [closing(stack, plain_session("client", connect=(where,), stamps=stamps)) for stamps in (False, True)]
    found, came = [], []
    frames = Frames(lambda key, message: found.append((key, *read(message))))

    def take(sample):
        frames.take(sample)
        came.append(sample)

    viewer.declare_subscriber("**", zenoh.handlers.Callback(take, indirect=False))
    for app in apps:
        pass_fence(viewer, app)

    def until_it_came(send):
        before = len(came)
        send()
        wait_until(lambda: len(came) > before, what="the sample")
        return found

    def publish(key, payload, *, stamped=False):
        put = partial(apps[stamped].put, key, payload, congestion_control=zenoh.CongestionControl.BLOCK)
        return until_it_came(put)

    publish.frames = frames
    publish.delete = lambda key: until_it_came(partial(apps[0].delete, key))
    return publish


def read(message):
    head, body = struct.unpack(">II", message[:8])
    assert len(message) == 8 + head + body
    return json.loads(message[8 : 8 + head]), message[8 + head :]


def test_images_go_on_untouched_and_other_samples_do_not(shown):
    """JPEG and PNG are known by how they begin."""
    shown("battery", b'{"charge": 0.1}')
    shown("empty", b"")
    shown.delete("a")
    shown("a", JPEG)
    assert [(key, head["type"], body) for key, head, body in shown("b", PNG)] == [
        ("a", "image/jpeg", JPEG),
        ("b", "image/png", PNG),
    ]


def test_the_age_is_that_of_the_stamp_by_our_clock(shown):
    """A robot whose clock is 5 s ahead stamps 5 s too late; without a stamp what the way takes is known."""
    shown.frames.know({"a": Delay(5.0, 0.5, 1e-3)})
    (_, head, _), (_, other, _) = shown("a", PNG) and shown("a", PNG, stamped=True)
    assert head["age"] == pytest.approx(0.5 + 1e-3 * len(PNG))
    assert other["age"] >= 5.0
    assert shown("b", PNG)[2][1]["age"] == 0.0


def test_what_is_too_large_is_not_shown(shown):
    """It is counted."""
    assert shown("a", JPEG + bytes(TUNING.image_bytes)) == []
    assert shown.frames.refused == 1


def test_of_too_many_cameras_those_are_shown_that_came_first(shown):
    """When one has been silent for long it makes room."""
    for number in range(TUNING.tiles):
        shown(f"camera/{number}", PNG)
    assert len(shown("one/more", PNG)) == TUNING.tiles
    assert shown.frames.refused == 1
    assert set(shown.frames.rates(float("inf")).values()) == {0.0}
    assert shown("one/more", PNG)[-1][0] == "one/more"


def test_rates_are_of_the_last_seconds(shown):
    """All three came within them."""
    for _ in range(3):
        found = shown("a", PNG)
    assert found[0][1]["rate"] * TUNING.rate_window == pytest.approx(1.0)
