"""What a demo lets the page do to its world."""

import pytest

from proxy.page.demo import Channel, DemoOrderError, read_red, read_robots, red_order


def test_a_channel_travels():
    """As JSON."""
    channel = Channel(750_000.0, 0.02, 0.01)
    assert Channel.read(channel.write()) == channel
    assert channel.write() == b'{"limit": 750000.0, "latency": 0.02, "loss": 0.01}'


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"[]",
        b'{"limit": 1}',
        b'{"limit": 0, "latency": 0, "loss": 0}',
        b'{"limit": 1, "latency": -1, "loss": 0}',
        b'{"limit": 1, "latency": 0, "loss": 1.1}',
        b'{"limit": NaN, "latency": 0, "loss": 0}',
        b'{"limit": "fast", "latency": 0, "loss": 0}',
        b'{"limit": null, "latency": 0, "loss": 0}',
        b'{"limit": 1' + 400 * b"0" + b', "latency": 0, "loss": 0}',
        100_000 * b"[",
    ],
)
def test_what_is_no_channel_is_refused(raw):
    """With what would be one."""
    with pytest.raises(DemoOrderError, match="a channel is"):
        Channel.read(raw)


def test_red_is_ordered_for_a_robot():
    """By its name."""
    assert read_red(red_order("r1")) == "r1"
    for raw in (b"", b"{}", b'{"robot": ""}', b'{"robot": 1}'):
        with pytest.raises(DemoOrderError, match="something red is ordered with"):
            read_red(raw)


def test_a_demo_says_who_can_be_given_red():
    """By their names; anybody may answer in a demo's place."""
    assert read_robots(b'{"robots": ["r1", "r2"]}') == ["r1", "r2"]
    for raw in (b"", b"{}", b'{"robots": 5}', b'{"robots": "r1"}', b'{"robots": [1]}', 100_000 * b"["):
        with pytest.raises(DemoOrderError, match="a demo answers with"):
            read_robots(raw)
