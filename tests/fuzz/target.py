"""What is fuzzed byte by byte: the codec, and a core that is fed with what it unpacks.

Data is a list of messages: a byte that says what, two of length, and that many bytes.
"""

import struct
import tempfile
from functools import cache
from pathlib import Path

from proxy.core.interface import events as ev
from proxy.core.protocol.digest_codec import pack_digest, unpack_digest
from proxy.core.protocol.envelope import MalformedWireError
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState, tag
from proxy.core.protocol.state_codec import pack_state, unpack_state
from tests.fuzz.hostile import Besieged
from tests.proxy.core.talk import ALL_KINDS
from utility_specs import Specs, load_specs

EVIL = tuple(f"eeeeeee{number}01" for number in range(4))
SENT = range(1000)
KINDS = ("digest", "state", "appear", "vanish", "sample", "publish", "time", "speak", "decide")


@cache
def specs() -> Specs:
    """Constraints of all kinds, and a type of cameras."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spec.toml"
        path.write_text(ALL_KINDS)
        return load_specs(path)


def one_input(data: bytes) -> None:
    """Feed a core with the messages in `data`; raises only what is a fault."""
    core = Besieged(specs())
    for kind, payload in messages(data):
        act(core, kind, payload)
        core.check()
    core.finish()


def messages(data, kinds=KINDS):
    """Split the data into messages of these kinds; what is cut off is one too. At most 64."""
    found, place = [], 0
    while place + 3 <= len(data) and len(found) < 64:
        kind, length = struct.unpack_from(">BH", data, place)
        found.append((kinds[kind % len(kinds)], data[place + 3 : place + 3 + length]))
        place += 3 + length
    return found


def act(core, kind, payload):
    """One message: who speaks is in the first byte."""
    zid = EVIL[payload[0] % len(EVIL)] if payload else EVIL[0]
    match kind:
        case "digest":
            hear(core, zid, payload[1:], digest_of, ev.DigestHeard)
        case "state":
            hear(core, zid, payload[1:], state_of, ev.StateHeard)
        case "appear":
            core.act(ev.PeerAppeared(core.now, payload[1:].decode("latin-1"), zid))
        case "vanish":
            core.act(ev.PeerGone(core.now, "evil", zid))
        case "sample":
            key = payload[1:].decode("latin-1")
            core.act(ev.SampleHeard(core.now, key, len(payload), payload[:4].hex(), None, None))
        case "publish":
            core.publish(payload[1:].decode("latin-1"), 100 * len(payload), delete=payload[:1] == b"d")
        case "time":
            core.pass_time(int.from_bytes(payload[:2], "big") / 100.0)
        case "speak":
            core.speak()
        case "decide":
            core.decide(send=payload[:1] == b"y")


def hear(core, zid, data, read, make):
    """What is read survives being packed; what cannot be read is malformed and nothing else."""
    try:
        heard = read(data, zid)
    except MalformedWireError:
        core.act(ev.MalformedHeard(core.now, "evil", "fuzz"))
    else:
        packed = pack_digest(heard) if isinstance(heard, Digest) else pack_state(heard)
        assert read(packed, zid) == heard
        core.act(make(core.now, heard))


def digest_of(data, zid):
    return unpack_digest(data, "evil", tag(zid), "00000000", SENT)


def state_of(data, _zid):
    return unpack_state(data, "evil")


def message(kind, payload):
    """The wire form of one message of the input."""
    return struct.pack(">BH", KINDS.index(kind), len(payload)) + payload


def seeds():
    """Inputs that go deep, to start from."""
    streams = (StreamState(1, "robot/evil/camera", "camera", 0.5, 0.01, 900, "periodic"),)
    state = State("evil", EVIL[0], "enforce", "s", streams, ("robot/**",), 1e6, (EVIL[0], "feed"), number=1)
    update = State("evil", EVIL[0], "", "", (StreamState(2, "robot/x/camera", "camera", 0.1),), number=2, since=1)
    news = (StreamDigest(1, 5, 3, 0.4, 0.3, 900, 2.0, (0.5,), 0.5, 10, 3), StreamDigest(2, 1, 0, 0.4, 0.0, 90, 1.0))
    echoes = (Echo("00000000", 0.05, 0.45, 3, 0.01, 1e-6),)
    brief = (
        StreamDigest(1, 7, 4, 0.6, 0.6, 0, -1.0),
        StreamDigest(2, 3, 1, 0.6, 0.6, 77, 2.0, (), 0.5, 1, 2),
    )
    digest = Digest("evil", tag(EVIL[0]), 0.5, 9, 999, news, echoes, 2, (0.5,), splits=True)
    announced = Digest("evil", tag(EVIL[0]), 0.6, streams=brief, state=2, brief=True)
    meet = message("appear", b"\x00evil")
    told = message("state", b"\x00" + pack_state(state)) + message("state", b"\x00" + pack_state(update))
    said = message("digest", b"\x00" + pack_digest(digest)) + message("digest", b"\x00" + pack_digest(announced))
    ours = message("publish", b"probot/r1/camera") + message("decide", b"y") + message("speak", b"")
    heard = message("sample", b"feedrobot/x/camera") + message("time", b"\x01\x00")
    return {
        "talk": meet + told + said + ours + heard + message("vanish", b"\x00"),
        "strangers": said + told + meet + said,
        "clones": meet + message("appear", b"\x01evil") + message("appear", b"\x02honest") + said + ours,
        "plain": heard + meet + told + heard,
    }
