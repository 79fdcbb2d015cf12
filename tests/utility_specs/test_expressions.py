"""Scale expressions: what they compute, and that they can do nothing else."""

import math
import threading
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.errors import ExpressionError
from utility_specs.expressions import CONSTANTS, DEEPEST, FUNCTIONS, LONGEST, Expression, Names

FEATURES = ("red", "size")
ALLOWED = (
    "write numbers, features, captured chunks, constants, + - * / % **, comparisons, and, or, not, if … else, "
    + ", ".join(FUNCTIONS)
)


def refusal(text: str, features=FEATURES) -> str:
    with pytest.raises(ExpressionError) as caught:
        Expression.compile(text, features)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 10 * red", 3.0),
        ("size % 3 - -1", 2.0),
        ("+red ** 2 / 2", 0.02),
        ("max(1, size, red) + min(red, 3)", 4.2),
        ("abs(-2) * sqrt(4) + log(e) + exp(0)", 6.0),
        ("clamp(size, 0, 1)", 1.0),
        ("5 if red > 0.1 else 1", 5.0),
        ("0.1 <= red < 0.3", 1.0),
        ("not red or size == 4 and size != 5 and red >= 0", 1.0),
        ("2 * pi", 2 * math.pi),
        ("red +\n  1", 1.2),
        ("  7  ", 7.0),
    ],
)
def test_an_expression_has_the_value_of_its_arithmetic(text, value):
    """Operators, functions, constants and conditions mean what they say."""
    assert math.isclose(Expression.compile(text, FEATURES).evaluate({"red": 0.2, "size": 4.0}), value)


def test_an_expression_knows_the_features_it_uses():
    """Constants and functions are no features."""
    assert Expression.compile("max(red, pi)", FEATURES).names == {"red"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        (" \n ", "is empty"),
        ("1 +", "is not an expression: invalid syntax (at its end)"),
        ("1 ++* red", "is not an expression: invalid syntax (column 5)"),
        (
            "x = 1",
            "is not an expression: invalid syntax (column 3); == compares",
        ),
        ("1or 2", "is not an expression: invalid decimal literal (column 1)"),
        ("\0", "is not an expression: source code string cannot contain null bytes (at its end)"),
        ("1" + " + 1" * LONGEST, "is longer than 500 characters"),
        ("-" * (DEEPEST + 1) + "1", "is nested too deeply"),
        ("(" * 240 + "1" + ")" * 240, "is not an expression: too many nested parentheses (column 201)"),
        ("1" * 400, "holds a number that is too large"),
        ("1 + red # so far\n+ size", "has a # in it; comments stand outside of expressions, for these are one line"),
        ("redd", 'unknown feature "redd" (did you mean "red"?)'),
        ("zz", 'unknown feature "zz" (known: "red", "size")'),
        ("mim(1, 2)", 'unknown function "mim" (did you mean "min"?)'),
        ("min(red)", "min takes at least 2 arguments, not 1"),
        ("sqrt()", "sqrt takes 1 argument, not 0"),
        ("clamp(1, 2)", "clamp takes 3 arguments, not 2"),
        ("min", "min is a function: write min(…)"),
        ("1 / 0", '"1 / 0" divides by zero'),
        ("red / (1 - 1)", '"red / (1 - 1)" divides by zero'),
        ("red % sqrt(0)", '"red % sqrt(0)" divides by zero'),
        ("'red'", '"red" is text; text can only be compared, with a captured chunk'),
        ("max('a', 1)", '"a" is text; text can only be compared, with a captured chunk'),
        ("red == 'high'", '"red" is a number, not text; text can only be compared with a captured chunk'),
        ("redd == 'high'", 'unknown feature "redd" (did you mean "red"?)'),
        ("'a' < 'b'", "\"'a' < 'b'\" orders text; text can only be compared by == and !="),
        ("(-1) ** 0.5", "has no value: math domain error"),
        ("9 ** 9 ** 9", "has no value: math range error"),
        ("1e999", "has no finite value: inf"),
        ("red.real", f'"red.real" is not arithmetic; {ALLOWED}'),
        ("red[0]", f'"red[0]" is not arithmetic; {ALLOWED}'),
        ("'a' * 9", '"a" is text; text can only be compared, with a captured chunk'),
        ("True", f'"True" is not arithmetic; {ALLOWED}'),
        ("1j", f'"1j" is not arithmetic; {ALLOWED}'),
        ("~1", f'"~1" is not arithmetic; {ALLOWED}'),
        ("1 << 9", f'"1 << 9" is not arithmetic; {ALLOWED}'),
        ("red in size", f'"red in size" is not arithmetic; {ALLOWED}'),
        ("min(1, key=red)", f'"min(1, key=red)" is not arithmetic; {ALLOWED}'),
        ("min(*red, 1)", f'"*red" is not arithmetic; {ALLOWED}'),
    ],
)
def test_what_is_not_arithmetic_over_features_is_refused_when_compiled(text, message):
    """Each mistake has its message."""
    assert refusal(text) == message


def test_half_a_character_is_no_expression():
    """Text that cannot be encoded is refused like any other mistake."""
    assert refusal("red + \ud800").startswith("is not an expression: 'utf-8' codec can't encode")


def test_a_type_without_features_is_told_so():
    """There is nothing to suggest then."""
    assert refusal("red", ()) == 'unknown feature "red" (this type has no features)'


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('id')",
        "().__class__.__mro__[1].__subclasses__()",
        "red.__class__",
        "(lambda: 1)()",
        "[x for x in (1,)]",
        "(x for x in (1,))",
        "{**{}}",
        "(red := 5)",
        "f'{red.__class__}'",
        "min.__globals__",
        "max(min, abs)",
        "min(min, 1)",
        "open('/etc/passwd')",
        "eval('1')",
        "print",
        "__builtins__",
        "await red",
        "yield",
        "red if (lambda: 1) else 2",
        "import os",
        "1; 2",
        "b'a'",
        "...",
        "None",
        "(1, 2)",
        "min(1, 2)(3)",
    ],
)
def test_no_expression_reaches_beyond_its_numbers(text):
    """Known ways out of evaluators are refused when compiled."""
    assert refusal(text)


def test_an_expression_without_a_value_for_these_features_says_so():
    """Division by zero, a missing feature, NaN: the error of this package, no other."""
    for text, values in [
        ("1 / red", {"red": 0.0}),
        ("red", {}),
        ("red", {"red": math.nan}),
        ("red", {"red": "x"}),
    ]:
        expression = Expression.compile(text, FEATURES)
        with pytest.raises(ExpressionError, match="has no"):
            expression.evaluate(values)


def test_threads_do_not_mix_their_features():
    """One expression serves several threads at once."""
    expression = Expression.compile("red + red * 0 + red", FEATURES)
    wrong = []

    def evaluate(value: float) -> None:
        wrong.extend(value for _ in range(2000) if expression.evaluate({"red": value}) != 2 * value)

    threads = [threading.Thread(target=evaluate, args=(float(i),)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def survives(text: str) -> None:
    with suppress(ExpressionError):
        assert math.isfinite(Expression.compile(text, FEATURES).evaluate({"red": 0.2, "size": 4.0}))


TOKENS = [
    "1",
    "0",
    "1e300",
    "red",
    "size",
    " ",
    "(",
    ")",
    "+",
    "-",
    "*",
    "**",
    "/",
    "%",
    "<",
    "==",
    ",",
    "if",
    "else",
]
TOKENS += [
    "and",
    "not ",
    " or ",
    ".",
    "[",
    "]",
    "{",
    "'",
    '"',
    "lambda",
    ":",
    "__class__",
    "\\",
    *FUNCTIONS,
    *CONSTANTS,
]


@given(st.text(max_size=40))
def test_any_text_is_an_expression_or_refused(text):
    """Compiling and evaluating raise nothing but the one error."""
    survives(text)


@given(st.lists(st.sampled_from(TOKENS), max_size=25).map("".join))
def test_any_words_of_the_language_are_an_expression_or_refused(text):
    """What looks like an expression never surprises either."""
    survives(text)


KNOWN = Names(frozenset({"red"}), frozenset({"robot", "n"}), {"bonus": 10.0})


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("bonus * n", 30.0),
        ("robot == 'r1'", 1.0),
        ("'r1' != robot", 0.0),
        ("2 if n == 3 else 1", 2.0),
        ("2 if n == '3' else 1", 2.0),
        ("robot == n", 0.0),
        ("robot != n == '3'", 1.0),
        ("red * (robot == 'r2') + n", 3.0),
    ],
)
def test_captured_chunks_are_text_beside_text_and_numbers_else(text, value):
    """Each side of a comparison tells which is meant."""
    values = {"red": 0.5, "robot:text": "r1", "n:text": "3", "n": 3.0}
    assert Expression.compile(text, KNOWN).evaluate(values) == value


def test_a_chunk_that_is_no_number_has_no_value_as_one():
    """Then the expression has none."""
    expression = Expression.compile("robot + 1", KNOWN)
    with pytest.raises(ExpressionError, match="has no value: 'robot' is not defined"):
        expression.evaluate({"robot:text": "r1"})


def test_what_always_has_the_same_value_is_computed_once():
    """An expression of constants needs nothing, and whether it has a value is known when it is compiled."""
    assert Expression.compile("bonus ** 2", KNOWN).evaluate({}) == 100.0
    with pytest.raises(ExpressionError, match="has no finite value: inf"):
        Expression.compile("bonus * 1e308", KNOWN)


def test_names_of_all_kinds_are_suggested():
    """Whatever the name might have meant."""
    with pytest.raises(ExpressionError, match=r'unknown feature "robt" \(did you mean "robot"\?\)'):
        Expression.compile("robt == 'r1'", KNOWN)
    with pytest.raises(ExpressionError, match=r'known: "bonus", "n", "red", "robot"'):
        Expression.compile("zzzz", KNOWN)
    with pytest.raises(ExpressionError, match=r"red is no function; write red \* \(…\) to multiply"):
        Expression.compile("red(2)", KNOWN)


@pytest.mark.parametrize(
    ("text", "filled"),
    [
        ("1 + 10 * red", "1 + 10 * <0.5>"),
        ("red +\n  red*bonus", "<0.5> + <0.5>*<7.0>"),
        ("2 if robot == 'é' and red > n else max(red, pi)", "2 if <r1> == 'é' and <0.5> > n else max(<0.5>, pi)"),
        ("5", "5"),
    ],
)
def test_values_stand_in_place_of_names(text, filled):
    """Of constants, too, and of text where text is compared; what is not known keeps its name."""
    known = Names(frozenset(["red"]), frozenset(["robot", "n"]), {"bonus": 7.0})
    values = {"red": 0.5, "robot:text": "r1"}
    assert Expression.compile(text, known).filled(values, lambda value: f"<{value}>") == filled
