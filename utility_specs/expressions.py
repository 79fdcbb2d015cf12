"""Arithmetic over features, as specs write it: `1 + 10 * red`.

An expression is checked whole when it is compiled: its grammar, its names, its calls. What is left holds only
numbers, which are floats, so it can neither reach anything else nor take long. `simpleeval` evaluates it.
"""

import ast
import math
import threading
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Self

from simpleeval import InvalidExpression, SimpleEval

from utility_specs.errors import ExpressionError
from utility_specs.suggestions import hint, quoted

LONGEST = 500
"""Characters of the longest expression."""

DEEPEST = 50
"""Levels of nesting of the deepest expression."""

CONSTANTS: Mapping[str, float] = {"pi": math.pi, "e": math.e}


def _clamp(x: float, low: float, high: float) -> float:
    """Return `x`, but at least `low` and at most `high`."""
    return min(max(x, low), high)


FUNCTIONS: Mapping[str, tuple[Callable[..., float], int, int]] = {
    "min": (min, 2, LONGEST),
    "max": (max, 2, LONGEST),
    "abs": (abs, 1, 1),
    "sqrt": (math.sqrt, 1, 1),
    "log": (math.log, 1, 1),
    "exp": (math.exp, 1, 1),
    "clamp": (_clamp, 3, 3),
}
"""Functions by name, each with the least and the greatest number of arguments. `log` is the natural one."""

_OPERATORS: Mapping[type[ast.AST], Callable[..., float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Mod: lambda a, b: a % b,
    ast.Pow: math.pow,  # never complex, unlike **
    ast.USub: lambda a: -a,
    ast.UAdd: lambda a: a,
    ast.Not: lambda a: not a,
    ast.Lt: lambda a, b: a < b,
    ast.LtE: lambda a, b: a <= b,
    ast.Gt: lambda a, b: a > b,
    ast.GtE: lambda a, b: a >= b,
    ast.Eq: lambda a, b: a == b,
    ast.NotEq: lambda a, b: a != b,
}
_ALLOWED = f"write numbers, features, + - * / % **, comparisons, and, or, not, if … else, {', '.join(FUNCTIONS)}"


@dataclass(frozen=True, slots=True)
class Expression:
    """A compiled expression; `names` are the features that it uses. Safe to evaluate from several threads."""

    text: str
    names: frozenset[str]
    _tree: ast.expr = field(repr=False, compare=False)
    _evaluator: SimpleEval = field(repr=False, compare=False)
    _lock: threading.Lock = field(default_factory=threading.Lock, repr=False, compare=False)

    @classmethod
    def compile(cls, text: str, features: Iterable[str]) -> Self:
        """Compile an expression over the named features; raises ExpressionError, which says what is wrong."""
        tree = _parsed(text)
        names = _Checker(frozenset(features)).check(tree)
        evaluator = SimpleEval(
            operators=dict(_OPERATORS),
            functions={name: function for name, (function, _, _) in FUNCTIONS.items()},
        )
        expression = cls(text, names, tree, evaluator)
        if not names:
            expression.evaluate({})
        return expression

    def evaluate(self, features: Mapping[str, float]) -> float:
        """Return the value, always finite; raises ExpressionError when there is none."""
        with self._lock:
            self._evaluator.names = {**CONSTANTS, **features}
            try:
                value = float(self._evaluator.eval(self.text, previously_parsed=self._tree))
            except (ArithmeticError, ValueError, TypeError, InvalidExpression) as error:
                raise ExpressionError(f"has no value: {error}") from None
        if not math.isfinite(value):
            raise ExpressionError(f"has no finite value: {value}")
        return value


def _parsed(text: str) -> ast.expr:
    """Parse an expression, which may spread over several lines."""
    line = " ".join(text.split())
    if not line:
        raise ExpressionError("is empty")
    if len(line) > LONGEST:
        raise ExpressionError(f"is longer than {LONGEST} characters")
    try:
        with warnings.catch_warnings(action="error"):  # "1or 2" is a warning to Python and a mistake to us
            return ast.parse(line, mode="eval").body
    except SyntaxError as error:
        place = f"column {error.offset}" if error.offset else "at its end"
        raise ExpressionError(f"is not an expression: {error.msg} ({place})") from None
    except (ValueError, MemoryError, RecursionError) as error:
        raise ExpressionError(f"is not an expression: {error}") from None


class _Checker:
    """Walks a tree, refuses all that is not arithmetic, and collects the features used."""

    def __init__(self, features: frozenset[str]) -> None:
        self._features = features
        self._used: set[str] = set()

    def check(self, tree: ast.expr) -> frozenset[str]:
        self._check(tree, 0)
        return frozenset(self._used)

    def _check(self, node: ast.expr, depth: int) -> None:
        if depth > DEEPEST:
            raise ExpressionError("is nested too deeply")
        match node:
            case ast.Constant():
                self._constant(node)
            case ast.Name():
                self._name(node.id)
            case ast.Call(func=ast.Name(id=name), keywords=[]):
                self._call(name, len(node.args))
                for argument in node.args:
                    self._check(argument, depth + 1)
            case _ if _is_operation(node):
                for child in ast.iter_child_nodes(node):
                    if isinstance(child, ast.expr):
                        self._check(child, depth + 1)
            case _:
                raise _refusal(node)

    @staticmethod
    def _constant(node: ast.Constant) -> None:
        """Make a number a float: whole ones could grow without bounds, and slowly."""
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            raise _refusal(node)
        try:
            node.value = float(node.value)
        except OverflowError:
            raise ExpressionError("holds a number that is too large") from None

    def _name(self, name: str) -> None:
        if name in FUNCTIONS:
            raise ExpressionError(f"{name} is a function: write {name}(…)")
        if name in self._features:
            self._used.add(name)
        elif name not in CONSTANTS:
            what = hint(name, sorted(self._features)) or " (this type has no features)"
            raise ExpressionError(f"unknown feature {quoted(name)}{what}")

    @staticmethod
    def _call(name: str, arguments: int) -> None:
        if name not in FUNCTIONS:
            raise ExpressionError(f"unknown function {quoted(name)}" + hint(name, FUNCTIONS))
        _, least, most = FUNCTIONS[name]
        if not least <= arguments <= most:
            wanted = f"{least}" if least == most else f"at least {least}"
            raise ExpressionError(f"{name} takes {wanted} argument{'s' if least > 1 else ''}, not {arguments}")


def _is_operation(node: ast.expr) -> bool:
    match node:
        case ast.BinOp() | ast.UnaryOp():
            return type(node.op) in _OPERATORS
        case ast.Compare():
            return all(type(op) in _OPERATORS for op in node.ops)
        case _:
            return isinstance(node, ast.BoolOp | ast.IfExp)


def _refusal(node: ast.expr) -> ExpressionError:
    return ExpressionError(f"{quoted(ast.unparse(node))} is not arithmetic; {_ALLOWED}")
