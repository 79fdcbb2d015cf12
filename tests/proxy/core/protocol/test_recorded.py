"""What daemons of earlier versions said, as recorded: neighbouring versions understand each other.

`recorded/wire_<version>.json` holds messages as daemons of that version pack them, in hexadecimal, and what they mean.
Who changes what is on the wire records it anew, under the next version; nothing that was recorded changes.
"""

import dataclasses
import json
import zlib
from pathlib import Path

import msgpack
import pytest

from proxy.core.protocol.digest_codec import digest_head, pack_digest, unpack_digest
from proxy.core.protocol.envelope import READABLE, VERSION, OtherVersionError
from proxy.core.protocol.messages import Digest
from proxy.core.protocol.state_codec import pack_state, state_version, unpack_state

FOLDER = Path(__file__).parent / "recorded"
RECORDED = {int(path.stem.removeprefix("wire_")): json.loads(path.read_text()) for path in FOLDER.glob("wire_*.json")}
CASES = [
    pytest.param(case, id=f"{version}-{case['kind']}-{case['name']}")
    for version, cases in sorted(RECORDED.items())
    if version in READABLE
    for case in cases
]
OUR_TAG, SENT = "deadbeef", [700_000]
"""Who heard what was recorded, and when it had sent a digest [ticks]."""
STREAM_ENDS = (0, 0, 0, 0, 0, 0, "")
"""What is left out at the end of what a state tells of a stream."""


def read(kind, data):
    if kind == "digest":
        return unpack_digest(data, "r1", "a1b2c3d4", OUR_TAG, SENT)
    return unpack_state(data, "r1")


def meant(message, recorded):
    """What a message means, as far as that was known when it was recorded."""
    return known(plain(message), recorded)


def known(message, recorded):
    """What of it was recorded: later versions tell more, also inside."""
    if not isinstance(message, dict) or not isinstance(recorded, dict):
        return message
    return {name: known(value, recorded[name]) for name, value in message.items() if name in recorded}


def inflated(data):
    return zlib.decompress(data) if data.startswith(b"\x78") else data


def plain(message):
    return json.loads(json.dumps(dataclasses.asdict(message)))


@pytest.mark.parametrize("case", CASES)
def test_what_was_recorded_means_what_it_meant(case):
    """A change that breaks what daemons that run today say is noticed here."""
    assert meant(read(case["kind"], bytes.fromhex(case["bytes"])), case["means"]) == case["means"]


@pytest.mark.parametrize("version", READABLE)
@pytest.mark.parametrize(
    ("kind", "name"), [("digest", "all"), ("digest", "announcement"), ("state", "told"), ("state", "update")]
)
def test_fields_that_a_later_version_adds_are_left_out(kind, name, version):
    """Of the whole message, and of what a state tells of a stream."""
    case = next(c for c in RECORDED[VERSION] if (c["kind"], c["name"]) == (kind, name))
    fields = msgpack.unpackb(inflated(bytes.fromhex(case["bytes"])))
    if name == "announcement":
        fields[3] = [[*stream, "new"] for stream in fields[3][2:]]
        case = case | {"means": case["means"] | {"streams": case["means"]["streams"][2:]}}
    elif kind == "digest":
        fields += [[]] * (9 - len(fields)) + [0] * (len(fields) < 10)
    elif name == "told":
        fields[4] = [[*stream, *STREAM_ENDS[len(stream) :], "new", 1] for stream in fields[4]]
        fields += [[]] * (15 - len(fields))
    else:
        fields += [[]] * (7 - len(fields))
    later = msgpack.packb([version, *fields[1:], ["new"], 5, "text"], use_single_float=True)
    assert meant(read(kind, later), case["means"]) == case["means"]


@pytest.mark.parametrize(("name", "partial"), [("all", False), ("least", False), ("split", True)])
def test_version_6_did_not_say_whether_it_told_of_all(name, partial):
    """What it said of parts without any stream may have been parts alone."""
    (case,) = [each for each in RECORDED[6] if (each["kind"], each["name"]) == ("digest", name)]
    assert read("digest", bytes.fromhex(case["bytes"])).partial is partial


@pytest.mark.parametrize(("split", "partial"), [([], False), ([1], True)])
def test_of_version_6_who_wants_parts_may_have_told_of_them_alone(split, partial):
    """Also that it has none of its own any more, as all have equal ones."""
    assert read("digest", msgpack.packb([6, 800_000, 1, 3, 100, [], [], [], split])).partial is partial


def test_other_versions_are_told_from_what_is_malformed():
    """Whatever else a message of one may be like."""
    for version in (0, VERSION + 2, 100, 70_000):
        for rest in ([{"a": 1}], [b"x" * 500, ["?"]], []):
            with pytest.raises(OtherVersionError, match=f"of version {version} ") as refused:
                unpack_digest(msgpack.packb([version, *rest]), "r1", "t")
            assert refused.value.version == version


def test_a_new_version_is_recorded_and_says_if_it_breaks_with_the_one_before():
    """Robots are upgraded one after the other: if they cannot work together meanwhile, users must know."""
    assert VERSION in RECORDED
    before = [version for version in RECORDED if version < VERSION]
    changes = (Path(__file__).parents[4] / "CHANGELOG.md").read_text()
    assert not before or max(before) in READABLE or f"wire version {VERSION}" in changes


@pytest.mark.parametrize(
    "case",
    [case for case in RECORDED[VERSION] if case["kind"] == "digest" or case["name"] == "told"],
    ids=lambda case: case["name"],
)
def test_what_is_said_today_is_what_was_recorded(case):
    """Who changes what daemons write has to see to those that read it."""
    message = read(case["kind"], bytes.fromhex(case["bytes"]))
    if isinstance(message, Digest):
        assert digest_head(bytes.fromhex(case["bytes"])) == (VERSION, message.sent)
        assert pack_digest(message).hex() == case["bytes"]
    else:
        assert state_version(bytes.fromhex(case["bytes"])) == VERSION
        assert inflated(pack_state(message)) == inflated(bytes.fromhex(case["bytes"]))
