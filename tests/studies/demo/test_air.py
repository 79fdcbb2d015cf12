"""What a medium is like, and how one says so."""

import json

import pytest

from studies.demo.air import Air, AirError, read_json


def test_what_is_said_changes_and_the_rest_stays():
    """Any of the keys."""
    air = Air(1e6, 0.1, 0.02)
    assert air.changed({"latency": 0.3}) == Air(1e6, 0.3, 0.02)
    assert air.changed({"limit": 5000, "loss": 0}) == Air(5000.0, 0.1, 0.0)
    assert air.changed({}) == air
    assert json.loads(air.to_json()) == {"limit": 1e6, "latency": 0.1, "loss": 0.02}


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ({"limits": 1e6}, "limits: unknown; a channel has limit, latency, loss"),
        ({"limit": 0}, "limit: 0 is not from 1000 to 1e+09 bytes a second"),
        ({"limit": "1 MB"}, "limit: '1 MB' is not a number"),
        ({"limit": True}, "limit: True is not a number"),
        ({"latency": -1}, "latency: -1 is not from 0 to 5 s"),
        ({"latency": None}, "latency: None is not a number"),
        ({"loss": float("nan")}, "loss: nan is not a number"),
        ({"loss": 1.5}, "loss: 1.5 is not from 0 to 1"),
        ([1], "a channel is changed with a JSON object"),
    ],
)
def test_what_cannot_be_is_refused_with_its_key(wanted, words):
    """And nothing changes."""
    with pytest.raises(AirError, match="^" + words.replace("+", r"\+")):
        Air(1e6).changed(wanted)


@pytest.mark.parametrize("raw", [b"", b"{", b"\xff\xfe"])
def test_what_is_no_json_is_refused(raw):
    """Whoever sends it hears so."""
    with pytest.raises(AirError, match="not JSON"):
        read_json(raw)
