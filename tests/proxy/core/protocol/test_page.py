"""`proxy/PROTOCOL.md` says what is on the wire: its tables hold for messages that are packed here."""

import dataclasses
import re
import zlib
from itertools import pairwise
from pathlib import Path

import msgpack
import pytest

from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.core.gossip.tuning import TUNING as GOSSIP
from proxy.core.protocol.bid import Segment
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.envelope import OLDEST, VERSION
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_backlog, pack_state
from proxy.core.protocol.tuning import TUNING

PAGE = (Path(__file__).parents[4] / "proxy" / "PROTOCOL.md").read_text()
KINDS = {
    "count": int,
    "ticks": int,
    "value": int | float,
    "number": int | float,
    "text": str,
    "tag": int | str,
    "id": bytes | str,
    "bytes": bytes | None,
    "list": list | None,
}

STREAM = StreamDigest(7, 10, 8, 11.5, 11.75, 40_000, 1.5, (0.25,), 0.5, -3, 12)
ECHO = Echo("deadbeef", 9.0, 9.5, 12, 0.25, 1e-6)
REPORT = SplitReport(7, (Segment(1200, 130),), 99, 98, (5, 6), 0.25, 3)
DIGEST = Digest("r1", "a1b2c3d4", 12.0, 3, 4000, (STREAM,), (ECHO,), 2, (0.5,), splits=True, split=REPORT, partial=True)
STATE = State(
    *("r1", "a1b2c3d4e5", "enforce", "s1", (StreamState(1, "k", "camera", 0.5, 0.01, 1000, "poisson"),)),
    *(("k/**",), 1.7e9, ("a1b2c3d4e5",), "unicast", 4, 0.5, "1.0.0", 77),
    splits=True,
    split=REPORT,
)


def tables():
    """All tables of the page, by the number of their columns: what stands in each row."""
    found = [[]]
    for before, line in pairwise(["", *PAGE.splitlines()]):
        if not line.startswith("|"):
            continue
        if not before.startswith("|"):
            found.append([])
        found[-1].append([cell.strip().strip("`") for cell in line.strip("|").split("|")])
    return [table for table in found if table]


FIELDS = [table[2:] for table in tables() if table[0] == ["place", "field", "type", "meaning"]]


def plain(data):
    return msgpack.unpackb(zlib.decompress(data) if data.startswith(b"\x78") else data)


def messages():
    """One of each list that is described, every field of it in use, in the order of the page."""
    digest = plain(pack_digest(DIGEST))
    announced = dataclasses.replace(STREAM, features=())
    announcement = plain(pack_digest(dataclasses.replace(DIGEST, brief=True, streams=(announced,))))
    state = plain(pack_state(STATE))
    yield from (digest, digest[5][0], digest[6], digest[8])
    yield from (announcement, announcement[3][0])
    yield from (state, state[4][0], plain(pack_backlog(1, ("k",))))


@pytest.mark.parametrize(("rows", "fields"), list(zip(FIELDS, messages(), strict=True)))
def test_every_field_is_in_its_place_and_of_its_type(rows, fields):
    """A field that is added is described; none is described that does not travel."""
    assert [int(place) for place, *_ in rows] == list(range(len(fields)))
    for (_, name, kind, _), value in zip(rows, fields, strict=True):
        assert isinstance(value, KINDS[kind]), name


@pytest.mark.parametrize(
    ("number", "message", "apart"),
    [
        (0, Digest, {"robot", "tag", "brief", "splits"}),
        (1, StreamDigest, set()),
        (2, Echo, set()),
        (3, SplitReport, set()),
        (5, StreamDigest, {"features"}),
        (6, State, {"robot", "splits"}),
        (7, StreamState, set()),
    ],
)
def test_every_field_has_the_name_that_it_has_in_the_code(number, message, apart):
    """But for what the key says, and what is said by another field."""
    named = {name for _, name, *_ in FIELDS[number]}
    assert {field.name for field in dataclasses.fields(message)} - named == apart


def test_an_update_has_the_first_fields_of_a_state():
    """As many as the page says."""
    update = plain(pack_state(dataclasses.replace(STATE, since=3)))
    assert update[:6] == [*plain(pack_state(STATE))[:3], 3, *plain(pack_state(STATE))[4:6]]
    assert update[6:] == plain(pack_state(STATE))[14:]
    assert "the first six fields alone" in PAGE


def test_the_keys_are_those_that_daemons_use():
    """On the mesh and on the side of the applications."""
    described = {row[0] for table in tables() if table[0] == ["key", "what it is"] for row in table[2:]}
    assert described == {
        keys.fleet("<robot>", "challenge"),
        *(keys.alive("<robot>", "<zid>"), keys.digest("<robot>", "<tag>"), keys.state("<robot>", "<tag>")),
        *(keys.backlog("<to>", "<tag>"), keys.kept("<to>", "<key>"), keys.fleet("<robot>", "<order>")),
        *(keys.at_apps("<robot>", "<zid>"), keys.status("<robot>"), keys.mode("<robot>")),
        keys.to_fleet("<robot>", "<order>"),
    }


@pytest.mark.parametrize(("head", "tuning"), [("bound", TUNING), ("timer or share", GOSSIP)])
def test_bounds_and_timers_are_those_in_force(head, tuning):
    """Whoever changes one changes the page."""
    (rows,) = [table[2:] for table in tables() if table[0][0] == head]
    assert {name: float(value) for name, value, _ in rows} == {name: getattr(tuning, name) for name, *_ in rows}


def test_versions_and_floods_are_those_in_force():
    """What stands in sentences."""
    assert f"It is the protocol of wire version {VERSION}." in PAGE
    assert f"none older than {OLDEST}." in PAGE
    each = BOUNDS.digests, BOUNDS.states, BOUNDS.backlogs
    every = BOUNDS.all_digests, BOUNDS.all_states, BOUNDS.all_backlogs
    (said,) = re.findall(r"up to (\d+) digests, (\d+) states and (\d+) backlogs", PAGE)
    assert tuple(map(float, said)) == each
    (said,) = re.findall(r"all together up to ([\d,]+), (\d+) and (\d+)\.", PAGE)
    assert tuple(float(number.replace(",", "")) for number in said) == every
