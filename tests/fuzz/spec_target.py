"""What operators write, fuzzed byte by byte: spec files, and expressions with the features that they are given."""

import math
from contextlib import suppress

from tests.fuzz.scratch import scratch
from tests.utility_specs.bad_specs import GOOD
from utility_specs import SpecsError
from utility_specs.check import Report
from utility_specs.errors import ExpressionError
from utility_specs.expressions import Expression, Names
from utility_specs.loader import load_set

RICH = """\
version = 1
floor = "5 %"
fallback = { urgent = "data", part = "30 %" }
constants = { bonus = 10, near = "5 s" }

[[constraint]]
kind = "airtime"
limit = "adaptive"
ceiling = 0.4
rate = "54 Mbit/s"

[[information_type]]
name = "camera"
keys = ["robot/${robot:*}/camera/${n:*}", "**/${robot:*}/${n:cam$*}"]
mode = "shadow"
min_rate = "1 Hz"
max_age = "5 s"
deletes = "decide"
queries = "drop"
utility = { kind = "table", points = [["0 s", 1.0], ["2 s", 0.0]] }
features.big = { kind = "size", default = 1 }
weight = "2 if robot == 'r1' else 1"
scale = "1 + bonus * log(big) + n"
forecast = { features = { big = "trend" }, schedule = { kind = "times", times = [0, 1], every = 9 }, size = "50 kB" }
"""
"""A spec with a bit of everything."""

KNOWN = Names(frozenset({"red", "size"}), frozenset({"robot", "n"}), {"bonus": 10.0, "zero": 0.0})
VALUES = {"red": 0.2, "size": 4e6, "robot:text": "r1", "n:text": "3", "n": 3.0}
WAYS_OUT = (
    "__import__('os').system('id')",
    "().__class__.__mro__[1].__subclasses__()",
    "robot.__class__ == 'r1'",
    "'r1'.format(robot) == robot",
    "robot * 99999999 == robot",
    "'r' * 9 ** 9 == robot",
    "9 ** 9 ** 9 ** 9",
    "[x for x in (1,) for y in (1,)]",
    "(lambda f: f(f))(lambda f: f(f))",
    "f'{robot.__class__}' == robot",
    "-" * 60 + "1",
    "(" * 240 + "1" + ")" * 240,
    "1" + "+1" * 249,
    "1 if 'a' == robot != n else max(zero, bonus) / zero",
)
"""Known ways out of evaluators, and known bombs."""


def one_file(data: bytes) -> None:
    """Load and check a file; raises only what is a fault."""
    path = scratch() / "spec.toml"
    path.write_bytes(data)
    with suppress(SpecsError):
        loaded = load_set([path])
        for each in loaded.specs.types:
            assert math.isfinite(each.scale({}))
        covering = loaded.specs.match("robot/r1/camera/3")
        assert covering is None or math.isfinite(covering.scale({}))
        for line in Report.on([path]).lines():
            assert "\n" not in line


def one_expression(data: bytes) -> None:
    """Compile an expression, and evaluate it twice; raises only what is a fault."""
    with suppress(ExpressionError):
        expression = Expression.compile(data.decode("utf-8", "replace"), KNOWN)
        assert expression.names <= set(KNOWN)
        value = expression.evaluate(VALUES)
        assert math.isfinite(value)
        assert value == expression.evaluate(VALUES)


def file_seeds() -> list[bytes]:
    """Specs to start from."""
    return [GOOD.encode(), RICH.encode()]


def expression_seeds() -> list[bytes]:
    """Expressions to start from, and known ways out."""
    good = ("1 + 10 * red", "2 if robot == 'r1' and n > 1 else clamp(size / bonus, 0, 1) ** 2")
    return [text.encode() for text in (*good, *WAYS_OUT)]
