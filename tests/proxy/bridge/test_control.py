"""What an operator asks and tells the daemon."""

import json

import pytest

from proxy.bridge import keys
from proxy.bridge.control import LIVE, Control, in_json
from proxy.bridge.serial_executor import SerialExecutor
from proxy.core.model.mode import Mode
from proxy.profiling.profile import read
from proxy.profiling.request import END, ProfileError, Request
from proxy.why import read as read_question
from tests.proxy.nodes import answers, closing, free_endpoint, plain_session
from tests.proxy.profiling.profiles import profile

FAILING = 7.0
"""A profile that takes so long fails [s]."""


@pytest.fixture
def switched():
    return []


@pytest.fixture
def asked():
    """What profiles were asked for."""
    return []


@pytest.fixture
def operator(stack, switched, asked):
    endpoint = free_endpoint()
    app = closing(stack, plain_session("router", listen=(endpoint,)))
    executor = SerialExecutor("test")

    def take(request, told):
        if asked:
            raise ProfileError("a profile is being taken; it ends in 9.0 s")
        asked.append(request)
        told(ProfileError("the profile failed") if request.seconds == FAILING else profile())

    stack.callback(executor.close, 1.0)
    control = Control(
        app=app,
        robot="r1",
        executor=executor,
        on_loop=lambda job: job(),
        status=lambda: {"robot": "r1", "counts": {"in": 3}},
        live=lambda: {"robot": "r1"},
        why=lambda raw: read_question(raw) and {"streams": [raw.decode()]},
        switch=switched.append,
        profile=take,
        end_profile=lambda told: told(profile()),
        specs=lambda: {"generation": "abc", "files": {"a.toml": "version = 1"}},
    )
    stack.callback(control.close)
    return closing(stack, plain_session("client", connect=(endpoint,)))


def test_the_status_is_json(operator):
    """Whoever asks one robot or all gets one answer."""
    for robot in ("r1", "*"):
        (answer,) = answers(operator, keys.status(robot))
        assert json.loads(answer) == {"robot": "r1", "counts": {"in": 3}}


def test_the_status_is_json_also_where_a_path_is_no_text():
    """And where a number is none: it is what `json` writes and reads."""
    for told in ({"path": "/etc/\udcff"}, {"a": float("inf"), "b": [1, 2**70, None, 0.1, "é"], "c": {"d": True}}):
        assert json.loads(in_json(told)) == told


def test_who_looks_again_and_again_is_told_less(operator):
    """If it asks for that."""
    (answer,) = answers(operator, keys.status("r1"), payload=LIVE)
    assert json.loads(answer) == {"robot": "r1"}


def test_a_mode_is_taken_and_confirmed(operator, switched):
    """The answer to a mode is that mode."""
    assert list(answers(operator, keys.mode("r1"), payload="shadow")) == ["shadow"]
    assert switched == [Mode.SHADOW]


@pytest.mark.parametrize("payload", ["fast", "", None, b"\xff"])
def test_anything_else_is_refused_with_what_would_be_right(operator, switched, payload):
    """An unknown mode changes nothing and says which there are."""
    (answer,) = answers(operator, keys.mode("r1"), payload=payload)
    assert answer == "error: a mode is one of pass, shadow, enforce"
    assert not switched


def test_decisions_are_told_as_json(operator):
    """What is no question is refused."""
    (answer,) = answers(operator, keys.why("r1"), payload='{"key": "a"}')
    assert json.loads(answer) == {"streams": ['{"key": "a"}']}
    (answer,) = answers(operator, keys.why("r1"))
    assert answer.startswith("error: decisions are asked for with")


def test_specs_in_force_are_told_as_json(operator):
    """With the text of their files."""
    (answer,) = answers(operator, keys.specs("r1"))
    assert json.loads(answer) == {"generation": "abc", "files": {"a.toml": "version = 1"}}


def test_a_profile_is_told_when_it_has_been_taken(operator, asked):
    """As JSON with its stacks; while one is being taken the next one is refused."""
    (answer,) = answers(operator, keys.profile("r1"), payload=Request(2.0, 50.0).write())
    assert read(json.loads(answer)) == profile()
    assert asked == [Request(2.0, 50.0)]
    (answer,) = answers(operator, keys.profile("r1"))
    assert answer == "error: a profile is being taken; it ends in 9.0 s"


def test_a_profile_that_fails_is_told_in_words(operator):
    """Whoever asked for it does not wait for ever."""
    (answer,) = answers(operator, keys.profile("r1"), payload=Request(FAILING).write())
    assert answer == "error: the profile failed"


def test_a_profile_that_is_ended_is_told_to_who_ends_it(operator, asked):
    """Nothing else is asked for then."""
    (answer,) = answers(operator, keys.profile("r1"), payload=END)
    assert read(json.loads(answer)) == profile()
    assert not asked


def test_a_profile_that_is_too_long_is_refused(operator, asked):
    """Before anything begins."""
    (answer,) = answers(operator, keys.profile("r1"), payload='{"seconds": 600}')
    assert answer == "error: seconds must be from 0.1 to 60, not 600"
    assert not asked
