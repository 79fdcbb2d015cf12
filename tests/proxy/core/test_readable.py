"""What a core tells the others is read by them, whatever happens: one malformed word after another silences it."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward, SendDigest, SendState, TellBacklog
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.digest_codec import pack_digest, unpack_digest
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState, tag
from proxy.core.protocol.state_codec import pack_backlog, pack_state, unpack_backlog, unpack_state
from proxy.core.protocol.tuning import TUNING
from tests.proxy.core.talk import Talk, only
from utility_specs import load_specs

SPECS = """
[[constraint]]
kind = "throughput"
limit = "adaptive"
floor = "40 kbit/s"
ceiling = "400 kbit/s"
window = 1.0
[[constraint]]
kind = "messages"
limit = 50
window = 1.0
[[information_type]]
name = "told"
keys = ["told/**"]
aggregation = "sum"
weight = "exp(f0)"
scale = "exp(f1)"
utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }
features.red = { kind = "size" }
FEATURES
[[information_type]]
name = "seen"
keys = ["seen/**"]
aggregation = "current"
scale = "exp(f0) * f1"
utility = { kind = "video" }
features.f0 = { kind = "size", default = 1.0 }
features.f1 = { kind = "size", default = 1.0 }
""".replace("FEATURES", "\n".join(f'features.f{n} = {{ kind = "size", default = 1.0 }}' for n in range(31)))

NUMBERS = (
    st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**70), 2**70).map(float) | st.floats(0.0, 800.0)
)
KEYS = st.builds(
    lambda begin, letter, length: f"{begin}/{letter * length}",
    st.sampled_from(["told", "seen", "other"]),
    st.sampled_from(["k", "温", "*", "🛰", "k/"]).filter(bool),
    st.sampled_from([1, 2, 60, 340, 1019, 1020]),
)
TIMES = st.floats(-1e9, 1e9)


@pytest.fixture(scope="module")
def specs(tmp_path_factory):
    path = tmp_path_factory.mktemp("specs") / "spec.toml"
    path.write_text(SPECS)
    return load_specs(path)


def read(command):
    """Read what a command tells the others."""
    match command:
        case SendDigest(digest):
            streams = unpack_digest(pack_digest(digest), "r1", "z-r1").streams
            assert [each.id for each in streams] == [each.id for each in digest.streams]
        case SendState(state, update):
            assert len(unpack_state(pack_state(state), "r1").streams) == len(state.streams)
            if update is not None:
                unpack_state(pack_state(update), "r1")
        case TellBacklog(_, number, keys):
            assert unpack_backlog(pack_backlog(number, keys))[1] == (None if keys is None else frozenset(keys))


@st.composite
def happenings(draw, now):
    """What others may say, and what applications and clocks may do, at a time [s]."""
    kind = draw(st.integers(0, 9))
    if kind < 5:
        features = dict.fromkeys((f"f{n}" for n in range(31)), draw(NUMBERS)) | {
            "red": draw(NUMBERS),
            "f1": draw(NUMBERS),
        }
        size, generated = draw(st.integers(0, TUNING.sample_bytes)), now - draw(st.floats(0.0, 3600.0))
        origin = draw(st.none() | st.binary(min_size=1, max_size=16).map(bytes.hex))
        yes = draw(st.booleans())
        return ev.SamplePublished(now, 0, draw(KEYS), size, generated, origin, 5, features, delete=yes and kind == 0)
    if kind == 5:
        sent, received = draw(TIMES), draw(TIMES)
        echo = Echo("z-r1", now - draw(st.floats(0.0, 10.0)), received, 2**40, draw(st.floats(0.0, 3600.0)), 3600.0)
        news = StreamDigest(1, 2**40, 2**40, sent, sent, 2**30, 1e15)
        return ev.DigestHeard(now, Digest("r2", tag("z-r2"), sent, 2**53, 2**53, (news,), (echo,), 1, (0.5, 0.5)), 99)
    if kind == 6:
        return ev.ClockChanged(now, draw(TIMES), draw(st.floats(0.0, 10.0)))
    if kind == 7:
        return draw(st.sampled_from([ev.PeerGone(now, "r2", "z-r2"), ev.PeerAppeared(now, "r2", "z-r2")]))
    if kind == 8:
        streams = (StreamState(1, "told/r2", "told", draw(st.floats(0.0, 86400.0)), 0.0, 2**30),)
        wall_offset = draw(TIMES)
        return ev.StateHeard(now, State("r2", "z-r2", "enforce", "", streams, ("**",), wall_offset, number=1), 99)
    return ev.SampleHeard(now, "told/r2", draw(st.integers(0, 2**30)), "z-r2", draw(st.none() | TIMES), None)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(
    data=st.data(), start=st.floats(0.0, 1e9), on_air=st.booleans(), coordination=st.sampled_from(["announce", "split"])
)
def test_all_that_a_core_tells_is_read(specs, data, start, on_air, coordination):
    """Whatever samples are worth and weigh, keys are called, clocks show, and others say."""
    how = {"coordination": coordination, "digests_on_air": on_air, "allowance": 1.0, "away": 600.0, "version": "1.0"}
    talk, now = Talk(Core(CoreSettings("r1", "z-r1", **how), specs, start)), start
    talk.want(now, "r2", "z-r2", ("**",))
    for number in range(data.draw(st.integers(1, 30))):
        now += data.draw(st.sampled_from([1e-4, 0.1, 1.0, 20.0, 4000.0]))
        event = data.draw(happenings(now))
        if isinstance(event, ev.SamplePublished):
            talk.samples += 1
            event = ev.SamplePublished(now, talk.samples, *(getattr(event, name) for name in event.__slots__[1:]))
        commands = talk.tell(event)
        for decide in only(commands, Decide):
            commands += talk.answer(now, decide, send=number % 2 == 0)
        for forward in only(commands, Forward):
            talk.tell(ev.SampleHanded(now, forward.sample))
        talk.tell(ev.TimePassed(now))
    for _ in range(3):
        now += 4.0
        talk.tell(ev.TimePassed(now))
    for command in talk.said:
        read(command)
