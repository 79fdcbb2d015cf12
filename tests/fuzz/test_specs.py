"""Spec files and expressions that anybody may write: either they are specs, or they are refused."""

import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fuzz.spec_target import RICH, WAYS_OUT, expression_seeds, file_seeds, one_expression, one_file
from tests.utility_specs.bad_rules import RULES
from tests.utility_specs.bad_specs import CORPUS
from tests.utility_specs.heavy_specs import HEAVY
from utility_specs import SpecsError
from utility_specs.check import Report
from utility_specs.errors import ExpressionError
from utility_specs.expressions import Expression
from utility_specs.loader import load_set
from utility_specs.toml_source import LARGEST_FILE

MOST_CALLS = 10_000
"""Calls of functions that judging a broken spec of ten lines may take; 4,000 are the most today."""
SCRAPS = [b"[[information_type]]", b"[[", b"=", b'"', b"'''", b"\n", b"nan", b"{}", b"1e999", b"\xff", b"${", b":*}"]
SCRAPS += [b"**", b"$*", b"min_rate", b"bypass = true", b'"1 Hz"', b'"0 %"', b"constants.x", b"fallback", b" == 'r1'"]
SCRAPS += [b"queries", b"mode", b"pass", b"0", b"-1", b"9" * 400, b"(" * 40, b"[" * 300, b"a." * 70, b"\\u0000"]
WORDS = ["red", "robot", "n", "bonus", "zero", "'r1'", "1", "1e300", "==", "!=", "<", "/", "%", "**", "*", "+", "-"]
WORDS += ["(", ")", ",", " if ", " else ", " and ", "not ", "max", "log", ".", "__class__", "[", "]", "lambda:", "="]


@st.composite
def mangled(draw):
    """A good spec with some places replaced by scraps."""
    raw = draw(st.sampled_from(file_seeds()))
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(raw)))
        length = draw(st.integers(0, 12))
        raw = raw[:start] + b"".join(draw(st.lists(st.sampled_from(SCRAPS), max_size=3))) + raw[start + length :]
    return raw


@given(mangled() | st.binary(max_size=100))
def test_any_bytes_are_either_a_spec_or_refused(data):
    """What is loaded can be used and checked, and every problem is one line."""
    one_file(data)


@pytest.mark.full
@given(st.lists(st.sampled_from(WORDS), max_size=25).map("".join) | st.text(max_size=40))
def test_any_text_is_either_an_expression_or_refused(text):
    """Values are finite, and the same each time."""
    one_expression(text.encode("utf-8", "surrogatepass"))


@pytest.mark.parametrize("data", [*file_seeds(), *(spec.text.encode() for spec in RULES[::8])])
def test_the_seeds_of_files_are_no_faults(data):
    """Fuzzing starts from them."""
    one_file(data)


@pytest.mark.parametrize("data", expression_seeds())
def test_the_seeds_of_expressions_are_no_faults(data):
    """Likewise."""
    one_expression(data)


@pytest.mark.parametrize("text", WAYS_OUT)
def test_known_ways_out_and_bombs_are_refused_when_compiled(text):
    """Even where captured chunks are text."""
    with pytest.raises(ExpressionError):
        Expression.compile(text, ("red",))


def test_the_rich_seed_is_a_spec(tmp_path):
    """So what is mangled goes deep."""
    (tmp_path / "rich.toml").write_text(RICH)
    (camera,) = load_set([tmp_path]).specs.types
    assert camera.keys == ("robot/*/camera/*", "*/**/cam$*")


def calls_of(action):
    """Count the calls of functions, Python's and C's, until `action` is done or refused."""
    calls = 0

    def count(_frame, event, _argument):
        nonlocal calls
        calls += event in {"call", "c_call"}

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        action()
    except (SpecsError, ExpressionError):
        pass
    finally:
        sys.setprofile(before)
    return calls


def test_the_work_for_a_broken_spec_is_bounded(tmp_path):
    """Counted in calls, so whatever the machine: no mistake makes anybody wait. What it imports, it imports once."""
    path = tmp_path / "bad.toml"
    path.write_text("x = 1\n")
    calls_of(lambda: load_set([path]))  # the schema of the format is made once
    for spec in (*CORPUS, *RULES):
        path.write_text(spec.text)
        assert any(calls_of(lambda: load_set([path])) < MOST_CALLS for _ in range(2)), spec.wrong[:80]


@pytest.mark.parametrize("text", HEAVY.values(), ids=HEAVY.keys())
def test_the_work_for_the_largest_broken_specs_is_bounded(tmp_path, text):
    """Even when they are made to be slow."""
    path = tmp_path / "heavy.toml"
    path.write_text("x = 1\n")
    calls_of(lambda: Report.on([path]))  # the schema of the format is made once
    path.write_text(text)
    assert len(text) <= LARGEST_FILE
    assert calls_of(lambda: Report.on([path])) < 25 * MOST_CALLS
    assert Report.on([path]).errors


BOMBS = ["1" + "/(1/1)" * 82, "1/(" * 48 + "1" + ")" * 48, "9**" * 48 + "9", "min(" + "1," * 240 + "1)"]
BOMBS += ["1" * 10**6, "(" * 10**6]


@pytest.mark.parametrize("text", BOMBS)
def test_the_work_for_an_expression_is_bounded(text):
    """By its length and depth, and nothing that it says."""
    assert calls_of(lambda: Expression.compile(text)) < 10 * MOST_CALLS
