"""What becomes of the samples of a key follows from rules, mode and specs, and is worked out once."""

from dataclasses import replace

import pytest

from proxy.bridge import courses as courses_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.courses import Courses
from proxy.bridge.rules import Rules
from proxy.config import BridgeConfig
from proxy.core.model.mode import Mode
from proxy.runtime import LiveRuntime, Runtime
from tests.proxy.bridge.test_ingress import OWN_RULES
from utility_specs import Specs, load_specs

RULES = {"out": {"deny": ["secret"], "bypass": ["alarm"]}}


@pytest.fixture
def live(tmp_path):
    path = tmp_path / "specs.toml"
    path.write_text(OWN_RULES)
    return LiveRuntime(Runtime(Mode.ENFORCE, load_specs(path)))


@pytest.fixture
def courses(live):
    return Courses(live, Rules(BridgeConfig.model_validate(RULES)), sourced=True)


@pytest.mark.parametrize(
    ("key", "reasons", "covered", "numbered"),
    [
        ("secret", ("dropped:denied", "passed:no-spec"), False, True),
        ("alarm", (None, "passed:bypass"), False, True),
        ("urgent/a", (None, "passed:bypass"), False, True),
        ("plain/a", (None, "passed:mode"), True, True),
        ("rest", (None, None), True, False),
        ("rest/@adv/pub/x", ("dropped:heartbeat", "passed:no-spec"), False, True),
        ("plain/a/@adv/pub/x", (None, "passed:no-spec"), False, True),
    ],
)
def test_rules_come_before_specs(courses, key, reasons, covered, numbered):
    """Heartbeats cross where the numbers that they tell do."""
    course = courses.of(key)
    assert (course.dropped, course.passes) == reasons
    assert (course.covering is not None, course.numbered, course.each) == (covered, numbered, False)


def test_a_course_stays_until_another_runtime_is_in_force(courses, live):
    """In mode `shadow` the core is told of each sample, without specs of none."""
    course = courses.of("rest")
    assert courses.of("rest") is course
    live.switch(Mode.SHADOW)
    assert courses.of("rest") == course._replace(each=True)
    live.swap(Specs.empty())
    assert courses.of("rest").passes == "passed:no-spec"


def test_numbers_that_were_left_out_once_stay_out(courses, live):
    """And what speaks of them; keys without a sample meanwhile keep theirs."""
    courses.of("rest")
    live.switch(Mode.PASS)
    numbered = {key: courses.numbered(key) for key in ("rest", "rest/other")}
    live.swap(Specs.empty())
    assert numbered == {"rest": False, "rest/other": True}
    assert not courses.of("rest").numbered
    assert courses.of("rest/@adv/pub/x").dropped == "dropped:heartbeat"
    assert courses.of("rest/other/@adv/pub/x").dropped is None


def test_what_covered_a_key_is_known_until_the_next_change(courses, live):
    """Samples may wait by it, but not of keys on which rules decide."""
    covering = courses.of("rest").covering
    live.swap(Specs.empty())
    for key, behind in (("rest", covering), ("alarm", None), ("secret", None)):
        assert (courses.of(key).covering, courses.of(key).behind) == (None, behind)
    assert courses.of("urgent/a").behind is None, "it never waited"
    live.switch(Mode.SHADOW)
    assert courses.of("rest").behind is covering, "these specs were before those in force"
    live.swap(Specs.empty())
    assert courses.of("rest").behind is None


def test_keys_that_are_remembered_are_bounded(courses, monkeypatch):
    """Of more all begin anew."""
    monkeypatch.setattr(courses_module, "BOUNDS", replace(BOUNDS, keys=1))
    course = courses.of("rest")
    courses.of("other")
    assert courses.of("rest") is not course


def test_nothing_is_numbered_where_replies_cannot_be(live):
    """Whatever rules and specs say."""
    courses = Courses(live, Rules(BridgeConfig.model_validate(RULES)), sourced=False)
    for key in ("alarm", "plain/a", "rest", "free"):
        assert not courses.numbered(key)
        assert not courses.of(key).numbered
