"""What is read of a snapshot, and what is refused: a recording is what somebody sent."""

import builtins
import os
import pickle
from collections import Counter, deque
from contextlib import suppress
from types import MappingProxyType

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from proxy.core.core import Core
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.parts import Parts
from proxy.recording.errors import RecordingError
from proxy.recording.pickling import pickled
from proxy.recording.spec_parts import SpecParts
from proxy.recording.unpickling import unpickled
from utility_specs import Specs

PARTS = SpecParts(Specs.empty())
HAPPENED = []


def happen(*of):
    """Leave a trace of having been called."""
    HAPPENED.append(of)


class Calls:
    """Pickles as a call of a function, or as an object with a state."""

    def __init__(self, *of):
        self.of = of

    def __reduce__(self):
        return self.of


def op(name):
    return pickle.PROTO + b"\x05" + name + pickle.STOP


def named(module, name):
    """Return the opcodes that name something."""
    return b"".join(pickle.SHORT_BINUNICODE + bytes([len(each)]) + each.encode() for each in (module, name)) + b"\x93"


GETATTR = named("builtins", "getattr")
HOSTILE = {
    "os.system": pickle.dumps(Calls(os.system, ("true",)), 5),
    "eval": pickle.dumps(Calls(builtins.eval, ("1",)), 5),
    "a function of ours": pickle.dumps(Calls(happen, (1,)), 5),
    "a function of the core": op(named("proxy.core.model.limits", "use_of") + b")R"),
    "a function that snapshots have": op(named("proxy.recording.pickling", "pickled") + b")R"),
    "a dotted name": op(named("proxy.core.core", "Core.handle") + b")R"),
    "what a module imports": op(named("proxy.core.forecast.features", "Mapping") + b")\x81"),
    "a module in a module": op(named("proxy.core.core", "ev") + b")\x81"),
    "a module that there is not": op(named("proxy.core.nowhere", "Core") + b")\x81"),
    "a path for a module": op(named("proxy.core./etc", "Core") + b")\x81"),
    "no text for a name": op(b"K\x01K\x01\x93"),
    "getattr": op(GETATTR + named("proxy.core.core", "Core") + b"\x8c\x06handle\x86R"),
    "the old opcode for names": op(b"cos\nsystem\n)R"),
    "the old opcode for calls": op(b"(S'true'\nios\nsystem\n"),
    "the constructor of a class": op(named("proxy.core.parts", "Parts") + b")R"),
    "an object with arguments": op(named("proxy.core.core", "Core") + b"K\x01\x85\x81"),
    "the fields of a class": op(named("proxy.core.core", "Core") + b"N}\x8c\x06handleK\x01s\x86b"),
    "other fields of a class": op(named("proxy.core.core", "Core") + b"}\x8c\x06handleK\x01sb"),
    "the fields of a member": op(named("proxy.core.model.mode", "Mode") + b"\x8c\x04pass\x85R}b"),
    "the fields of a tuple": op(named("proxy.core.view.stream", "Sent") + b"(K\x01K\x01K\x01K\x01K\x01t\x81}b"),
    "the fields of specs": op(named("proxy.recording.pickling", "part") + b"K\x00\x85R}b"),
    "a field with underscores": op(named("proxy.core.core", "Core") + b")\x81}\x8c\x09__class__K\x01sb"),
    "a field that is no text": op(named("proxy.core.core", "Core") + b")\x81}K\x01K\x01sb"),
    "a state that is none": op(named("proxy.core.core", "Core") + b")\x81K\x01b"),
    "too few fields": op(named("proxy.core.parts", "Parts") + b")\x81)b"),
    "too few elements": op(named("proxy.core.view.stream", "Sent") + b")\x81"),
    "a class for a value": op(named("proxy.core.core", "Core") + b"\x85"),
    "a class in a list": op(b"](" + named("proxy.core.core", "Core") + b"e"),
    "a tuple with too little": op(b"K\x01\x87"),
    "a call of a value": op(b"K\x01)R"),
    "an object of a value": op(b"K\x01)\x81"),
    "a list of a number": op(b"K\x01(K\x01e"),
    "a table of a list": op(b"](K\x01K\x01u"),
    "a set of a list": op(b"](K\x01\x90"),
    "a large queue": op(named("collections", "deque") + b"](K\x01e\x85R"),
    "a counter with contents": op(named("collections", "Counter") + b"}\x85R"),
    "no such part": op(named("proxy.recording.pickling", "part") + b"K\x63\x85R"),
    "a part with features that has none": op(named("proxy.recording.pickling", "part") + b"K\x00}\x86R"),
    "no such member": op(named("proxy.core.model.mode", "Mode") + b"\x8c\x01x\x85R"),
    "a key that is too deep": op(b"})" + b"\x85" * 2000 + b"K\x01s"),
    "a set that is too deep": op(b"\x8f()" + b"\x85" * 2000 + b"\x90"),
    "a key that is a list": op(b"}]K\x01s"),
    "a value that was not remembered": op(b"h\x07"),
    "two values": op(b"K\x01K\x01"),
    "no end": b"\x80\x05K\x01",
    "no pickle": b"hello",
    "nothing": b"",
}


@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE.keys())
def test_nothing_but_a_snapshot_is_read(data, monkeypatch):
    """It is refused, and runs nothing."""
    monkeypatch.setattr(os, "system", happen)
    monkeypatch.setattr(builtins, "eval", happen)
    with pytest.raises(RecordingError, match=r"the snapshot of the core is (refused|damaged)"):
        unpickled(data, PARTS)
    assert not HAPPENED
    assert Core.handle.__qualname__ == "Core.handle"


def test_a_hostile_state_runs_nothing_of_it():
    """A core of nothing is refused when it is put together."""
    with pytest.raises(RecordingError, match="damaged: AttributeError"):
        unpickled(op(named("proxy.core.core", "Core") + b")\x81}b"), PARTS)


@pytest.mark.parametrize(
    ("data", "value"),
    [
        (op(named("collections", "deque") + b")K\x02\x86R(K\x01K\x02e"), deque([1, 2], 2)),
        (op(named("collections", "Counter") + b")R(K\x01K\x02u"), Counter({1: 2})),
        (op(named("proxy.recording.pickling", "view") + b"}\x85R"), MappingProxyType({})),
        (op(named("proxy.core.model.mode", "Mode") + b"\x8c\x04pass\x85R"), Mode.PASS),
        (op(b"]K\x01a"), [1]),
        (op(b"}K\x01K\x02s"), {1: 2}),
        (op(b"\x8f(K\x01\x90"), {1}),
        (op(b"(K\x01\x91"), frozenset({1})),
        (op(b"(K\x01K\x01K\x01K\x01t"), (1, 1, 1, 1)),
        (op(b"K\x01\x94(h\x00h\x001K\x02\x86"), (1, 2)),
        (op(b"K\x01K\x020"), 1),
        (op(named("proxy.recording.pickling", "part") + b"K\x00\x85R"), Specs.empty()),
    ],
)
def test_what_snapshots_have_is_read(data, value):
    """Containers, members, parts of specs."""
    assert unpickled(data, PARTS) == value


def test_a_core_is_read_with_all_that_it_has():
    """Objects of all kinds of classes, each once."""
    core = Core(CoreSettings("r1", "z1"), Specs.empty(), 1.0)
    read = unpickled(pickled(core), PARTS)
    assert type(read.parts) is Parts
    assert read.settings == core.settings
    assert read.parts.view is read.view
    assert read.view.specs is PARTS.at((0,))
    assert read.wake_at(1.0) == core.wake_at(1.0)


@pytest.fixture(scope="module")
def snapshot():
    return pickled(Core(CoreSettings("r1", "z1"), Specs.empty(), 1.0))


def test_a_snapshot_that_is_cut_off_is_damaged(snapshot):
    """Wherever that is."""
    for length in range(0, len(snapshot) - 1, 97):
        with pytest.raises(RecordingError):
            unpickled(snapshot[:length], PARTS)


@hypothesis_settings(max_examples=150)
@given(st.data())
def test_a_damaged_snapshot_is_read_or_refused(snapshot, data):
    """Nothing else is raised, whatever is in its bytes."""
    raw = bytearray(snapshot)
    for place in data.draw(st.lists(st.integers(0, len(raw) - 1), min_size=1, max_size=8)):
        raw[place] = data.draw(st.integers(0, 255))
    with suppress(RecordingError):
        unpickled(bytes(raw), PARTS)
