"""What the status says of the core."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.protocol.messages import Digest, tag


@pytest.mark.parametrize("ends", [False, True])
def test_a_stream_that_is_heard_is_not_over(make_talk, ends):
    """Though its robot tells nothing of it in its digests, as one without specs; it is when nothing more comes."""
    talk = make_talk()
    talk.want(0.0, "r2", "z-r2", ())
    for number in range(120):
        now = float(number)
        talk.tell(ev.DigestHeard(now, Digest("r2", tag("z-r2"), now), 50))
        if not ends or number < 10:
            talk.tell(ev.SampleHeard(now + 0.01, "robot/r2/camera", 1000, "z-r2", now, None))
    (stream,) = talk.core.status(120.0)["streams"]
    assert stream["robot"] == "r2"
    assert stream["over"] is ends
