"""What is asked of the daemon."""

import pytest

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.questions import refuse, serve
from proxy.bridge.serial_executor import SerialExecutor
from tests.proxy.nodes import answers, closing, free_endpoint, plain_session

KEY = "@sendworthy/r1/why"


@pytest.fixture
def looked():
    """The sizes of the questions that the loop was given."""
    return []


@pytest.fixture
def operator(stack, looked):
    endpoint = free_endpoint()
    app = closing(stack, plain_session("router", listen=(endpoint,)))
    executor = SerialExecutor("test")
    stack.callback(executor.close, 1.0)

    def answer(query):
        looked.append(len(query.payload or b""))
        refuse(query, "looked at")

    served = serve(app, KEY, answer, executor=executor, on_loop=lambda job: job())
    stack.callback(served.undeclare)
    return closing(stack, plain_session("client", connect=(endpoint,)))


@pytest.mark.parametrize("payload", [None, b"", b"x" * BOUNDS.question_bytes])
def test_a_question_is_answered_on_the_loop(operator, looked, payload):
    """Whatever it says."""
    assert list(answers(operator, KEY, payload=payload)) == ["error: looked at"]
    assert looked == [len(payload or b"")]


def test_a_question_that_is_too_large_is_refused_before_the_loop_looks_at_it(operator, looked):
    """One of 26 MB held up all decisions for three seconds."""
    (answer,) = answers(operator, KEY, payload=b"x" * (BOUNDS.question_bytes + 1))
    assert answer == f"error: a question has at most {BOUNDS.question_bytes} bytes"
    assert not looked
