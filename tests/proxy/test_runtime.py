"""Mode and specs have one home, and are swapped whole."""

from dataclasses import FrozenInstanceError

import pytest

from proxy.core.model.mode import Mode
from proxy.runtime import LiveRuntime, Runtime
from utility_specs import Specs, load_specs

TYPES = """
[[information_type]]
name = "urgent"
keys = ["urgent/**"]
bypass = true
utility = { kind = "video" }
[[information_type]]
name = "plain"
keys = ["plain/**"]
mode = "pass"
queries = "drop"
utility = { kind = "video" }
"""
FACTS = """
[[information_type]]
name = "facts"
keys = ["facts/**"]
aggregation = "sum"
utility = { kind = "video" }
"""
LIMITS = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 0.5
[[constraint]]
kind = "throughput"
limit = "8 kbit/s"
window = 2.0
"""
ADAPTIVE = """
[[constraint]]
kind = "throughput"
limit = "adaptive"
floor = "8 kbit/s"
ceiling = "80 kbit/s"
window = 0.5
"""


@pytest.fixture
def load(tmp_path):
    """Specs from text."""

    def loaded(text):
        path = tmp_path / "specs.toml"
        path.write_text(text)
        return load_specs(path)

    return loaded


def test_who_took_a_runtime_keeps_it_when_another_one_is_put_in_force(load):
    """A value is never half of one generation and half of the next."""
    before, after = load(TYPES + FACTS), load(TYPES + FACTS + LIMITS)
    live = LiveRuntime(Runtime(Mode.SHADOW, before))
    taken = live.runtime
    live.switch(Mode.ENFORCE)
    live.swap(after)
    assert (taken.mode, taken.specs) == (Mode.SHADOW, before)
    assert live.runtime == Runtime(Mode.ENFORCE, after)
    with pytest.raises(FrozenInstanceError):
        taken.mode = Mode.PASS


def test_a_type_is_treated_in_its_own_mode_or_in_that_of_the_daemon(load):
    """Where the daemon passes everything no type has a mode of its own."""
    specs = load(TYPES + FACTS)
    plain, facts = specs.match("plain/a"), specs.match("facts/a")
    assert [Runtime(mode, specs).mode_of(facts) for mode in Mode] == list(Mode)
    assert {Runtime(mode, specs).mode_of(plain) for mode in Mode} == {Mode.PASS}


def test_only_what_is_covered_and_enforced_is_dropped_on_purpose(load):
    """Neither what bypasses the planner, nor what only passes, nor what no type covers."""
    specs = load(TYPES + FACTS)

    def drops(runtime, key):
        return runtime.drops(specs.match(key))

    dropped = {
        mode: [
            key for key in ("urgent/a", "plain/a", "facts/a", "free") if Runtime(mode, specs).drops(specs.match(key))
        ]
        for mode in Mode
    }
    assert dropped == {Mode.PASS: [], Mode.SHADOW: [], Mode.ENFORCE: ["facts/a"]}


def test_what_specs_say_of_a_key_is_what_those_in_force_say(load):
    """From the swap on, for who asks by key."""
    live = LiveRuntime(Runtime(Mode.ENFORCE, Specs.empty()))
    asked = (live.match, live.counts_each, live.drops_queries)
    assert [each("facts/a") for each in asked] == [None, False, False]
    live.swap(load(TYPES + FACTS))
    assert live.match("facts/a").name == "facts"
    assert [live.counts_each(key) for key in ("facts/a", "plain/a", "free")] == [True, False, False]
    assert [live.drops_queries(key) for key in ("facts/a", "plain/a", "free")] == [False, True, False]


def test_the_tightest_limit_sets_the_pace_where_it_is_enforced(load):
    """Nothing is paced without a limit, nor where some samples go whatever was decided."""
    types = load(TYPES + FACTS)
    limits = load(LIMITS + FACTS)
    assert Runtime(Mode.ENFORCE, limits).pace == 1000.0
    assert [Runtime(mode, limits).pace for mode in (Mode.PASS, Mode.SHADOW)] == [None, None]
    assert Runtime(Mode.ENFORCE, types).pace is None
    shadowed = load(LIMITS + FACTS + TYPES.replace('mode = "pass"', 'mode = "shadow"'))
    assert Runtime(Mode.ENFORCE, shadowed).pace is None


def test_a_runtime_tells_whether_any_limit_follows_the_channel(load):
    """Only then somebody has to look at the links."""
    assert not Runtime(Mode.ENFORCE, load(LIMITS + FACTS)).adaptive
    assert Runtime(Mode.ENFORCE, load(ADAPTIVE + FACTS)).adaptive
