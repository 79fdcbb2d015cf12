"""Which sample goes in a turn by the clock, as transcripts of one robot of a large team."""

from itertools import pairwise

import pytest

from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward
from proxy.core.protocol.messages import Digest, State, StreamState, tag
from proxy.core.protocol.state_codec import pack_state
from tests.proxy.core.talk import only

SPEC = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 1.0
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
weight = 10
utility = {{ kind = "step", lifetime = "60 s" }}
[[information_type]]
name = "map"
keys = ["robot/*/map"]
utility = {{ kind = "step", lifetime = "60 s" }}
{guarantee}
"""
FRAME = 4_000


@pytest.fixture
def make_talk_of_many(make_talk, make_specs):
    """A robot of a large team whose others have cameras; one of them finds that limits have to be split."""

    def make(guarantee):
        talk = make_talk(make_specs(text=SPEC.format(guarantee=guarantee)), allowance=0.02)
        talk.want(0.0, keys=("robot/**",))
        for name in (f"x{number}" for number in range(TUNING.large_team)):
            camera = StreamState(1, f"robot/{name}/camera", "camera", 1.0, size=FRAME, schedule="periodic")
            talk.tell(ev.PeerAppeared(0.0, name, f"z-{name}"))
            state = State(name, f"z-{name}", "enforce", "", (camera,), (), number=1)
            talk.tell(ev.StateHeard(0.0, state, len(pack_state(state))))
        vote = Digest("x0", tag("z-x0"), 0.1, 0, 0, state=1, splits=True)
        talk.tell(ev.DigestHeard(0.1, vote, 40))
        return talk

    return make


def sent(talk, turns):
    """Publish a map and an image once a second for so many turns; return which went when [s]."""
    kinds, found = dict[int, str](), list[tuple[float, str]]()
    for step in range(10, 100 * 100):
        now = 0.01 * step
        said = talk.tell(ev.TimePassed(now))
        if step % 100 == 0:
            for kind in ("map", "camera"):
                sample, more = talk.publish(now, key=f"robot/r1/{kind}", size=FRAME)
                kinds[sample], said = kind, [*said, *more]
        while decides := only(said, Decide):
            found += [(now, kinds[each.sample]) for each in only(said, Forward)]
            said = talk.answer(now, decides[0], send=True)
        found += [(now, kinds[each.sample]) for each in only(said, Forward)]
        if len(found) == turns:
            break
    return found


@pytest.mark.parametrize(
    ("guarantee", "goes"), [("", ["map", "camera", "camera"]), ('min_rate = "0.03 Hz"', ["map", "map", "map"])]
)
def test_in_a_turn_that_goes_which_gains_most(make_talk_of_many, guarantee, goes):
    """What is guaranteed first; the oldest where nothing was sent yet."""
    talk = make_talk_of_many(guarantee)
    found = sent(talk, len(goes))
    assert talk.core.budget.coordination.equal.by_clock
    assert [kind for _, kind in found] == goes
    assert all(later - at > 10.0 for (at, _), (later, _) in pairwise(found))
