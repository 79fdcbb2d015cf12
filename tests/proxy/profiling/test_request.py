"""What may be asked for."""

import pytest

from proxy.profiling.request import ProfileError, Request, read


def test_what_is_written_is_read():
    """And what is not said is as usual."""
    assert read(Request(3.0, 50.0).write()) == Request(3.0, 50.0)
    assert read(b"") == Request()
    assert read(b'{"seconds": 2}') == Request(2.0)


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b'{"seconds": 61}', "seconds must be from 0.1 to 60, not 61"),
        (b'{"seconds": 0}', "seconds must be from 0.1 to 60, not 0"),
        (b'{"seconds": NaN}', "seconds must be from 0.1 to 60, not nan"),
        (b'{"rate": 1e6}', "rate must be from 1 to 1000, not 1e"),
        (b'{"second": 1}', "a profile is asked for with"),
        (b'{"seconds": []}', "a profile is asked for with"),
        (b'{"seconds": 1' + b"0" * 400 + b"}", "a profile is asked for with"),
        (b"[" * 100_000, "a profile is asked for with"),
        (b"[3]", "a profile is asked for with"),
        (b"\xff", "a profile is asked for with"),
    ],
)
def test_anything_else_is_refused_with_what_would_be_right(raw, message):
    """Profiles are bounded."""
    with pytest.raises(ProfileError, match=message):
        read(raw)
