"""Arithmetic over features, captured chunks of keys and constants, as specs write it: `1 + 10 * red`.

An expression is checked whole when it is compiled: its grammar, its names, its types, its calls. What is left holds
only numbers, which are floats, and text that is compared, so it can neither reach anything else nor take long.
`simpleeval` evaluates it.
"""

import ast
import math
import re
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Self

from simpleeval import InvalidExpression, SimpleEval

from utility_specs.errors import ExpressionError
from utility_specs.key_formats import as_text
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
_ALLOWED = (
    "write numbers, features, captured chunks, constants, + - * / % **, comparisons, and, or, not, if … else, "
    + ", ".join(FUNCTIONS)
)


@dataclass(frozen=True, slots=True)
class Names:
    """What an expression may use by name: features, captured chunks of the key, constants with their values."""

    features: frozenset[str] = frozenset()
    captures: frozenset[str] = frozenset()
    constants: Mapping[str, float] = field(default_factory=dict)

    def __contains__(self, name: object) -> bool:
        """Whether it is one of them."""
        return name in self.features or name in self.captures or name in self.constants

    def __iter__(self) -> Iterator[str]:
        """All of them in order, those that every expression knows apart."""
        return iter(sorted({*self.features, *self.captures, *self.constants}))


@dataclass(frozen=True, slots=True)
class Expression:
    """A compiled expression; `names` are the features, captured chunks and constants that it uses.

    Safe to evaluate from several threads.
    """

    text: str
    names: frozenset[str]
    _known: Mapping[str, float] = field(repr=False, compare=False)
    _tree: ast.expr = field(repr=False, compare=False)
    _evaluator: SimpleEval = field(repr=False, compare=False)
    _lock: threading.Lock = field(default_factory=threading.Lock, repr=False, compare=False)
    _value: float | None = field(default=None, compare=False)
    """Of an expression that always has the same."""

    @classmethod
    def compile(cls, text: str, known: Names | Iterable[str] = ()) -> Self:
        """Compile an expression over known names, or features; raises ExpressionError, which says what is wrong."""
        known = known if isinstance(known, Names) else Names(frozenset(known))
        line = " ".join(text.split())
        tree = _parsed(line)
        checker = _Checker(line, known)
        value = checker.check(tree)
        names = frozenset(checker.names)
        constants = {name: known.constants[name] for name in names & known.constants.keys()}
        constant = names <= constants.keys()
        if constant and value is not None and math.isfinite(value):
            return cls(text, names, constants, tree, _SHARED, _value=value)
        expression = cls(text, names, {**CONSTANTS, **constants}, tree, _evaluator())
        return replace(expression, _value=expression.evaluate({})) if constant else expression

    def evaluate(self, values: Mapping[str, float | str]) -> float:
        """Return the value for features and captured chunks, always finite; raises ExpressionError if there is none."""
        if self._value is not None:
            return self._value
        with self._lock:
            self._evaluator.names = {**self._known, **values}
            try:
                value = float(self._evaluator.eval(self.text, previously_parsed=self._tree))
            except (ArithmeticError, ValueError, TypeError, InvalidExpression) as error:
                raise ExpressionError(f"has no value: {str(error).removeprefix('float ')}") from None
        if not math.isfinite(value):
            raise ExpressionError(f"has no finite value: {value}")
        return value

    def filled(self, values: Mapping[str, float | str], write: Callable[[float | str], str]) -> str:
        """Return the text with values in place of the names that have some, as `write` writes them."""
        known = {**self._known, **values}
        names = [node for node in ast.walk(self._tree) if isinstance(node, ast.Name) and node.id not in CONSTANTS]
        line = " ".join(self.text.split()).encode()  # places count bytes
        for node in sorted(names, key=lambda node: node.col_offset, reverse=True):
            if node.id in known:
                line = line[: node.col_offset] + write(known[node.id]).encode() + line[node.end_col_offset :]
        return line.decode()


def _evaluator() -> SimpleEval:
    return SimpleEval(operators=dict(_OPERATORS), functions={name: each[0] for name, each in FUNCTIONS.items()})


_SHARED = _evaluator()
"""That of all expressions that have one value: they have no need of it."""


def _parsed(line: str) -> ast.expr:
    if not line:
        raise ExpressionError("is empty")
    if len(line) > LONGEST:
        raise ExpressionError(f"is longer than {LONGEST} characters")
    if "#" in line:
        raise ExpressionError("has a # in it; comments stand outside of expressions, for these are one line")
    try:
        with warnings.catch_warnings(action="error"):  # "1or 2" is a warning to Python and a mistake to us
            return ast.parse(line, mode="eval").body
    except SyntaxError as error:
        place = f"column {error.offset}" if error.offset else "at its end"
        hint = "; == compares" if re.search(r"[^=<>!:]=[^=]", line) else ""
        raise ExpressionError(f"is not an expression: {error.msg} ({place}){hint}") from None
    except (ValueError, MemoryError, RecursionError) as error:
        raise ExpressionError(f"is not an expression: {error}") from None


class _Checker:
    """Walks a tree, refuses all that is not arithmetic, and collects the names used."""

    def __init__(self, line: str, known: Names) -> None:
        self._line = line
        self._known = known
        self.names: set[str] = set()

    def check(self, node: ast.expr, depth: int = 0) -> float | None:
        """Return the value of a part, as far as it is known without features and captured chunks."""
        if depth > DEEPEST:
            raise ExpressionError("is nested too deeply")
        match node:
            case ast.Constant():
                return self._constant(node)
            case ast.Name():
                return self._name(node.id)
            case ast.Call(func=ast.Name(id=name), keywords=[]):
                self._call(name, len(node.args))
                return _value(FUNCTIONS[name][0], [self.check(each, depth + 1) for each in node.args])
            case ast.UnaryOp() | ast.BinOp() if type(node.op) in _OPERATORS:
                return self._operation(node, depth)
            case ast.Compare() if self._compares_text(node):
                self._texts(node)
            case ast.Compare() | ast.BoolOp() | ast.IfExp() if _known(node):
                for child in ast.iter_child_nodes(node):
                    if isinstance(child, ast.expr):
                        self.check(child, depth + 1)
            case _:
                raise _refusal(node)
        return None

    def _operation(self, node: ast.UnaryOp | ast.BinOp, depth: int) -> float | None:
        operands = [node.operand] if isinstance(node, ast.UnaryOp) else [node.left, node.right]
        values = [self.check(each, depth + 1) for each in operands]
        if values[-1] == 0.0 and isinstance(node.op, ast.Div | ast.Mod):
            written = ast.get_source_segment(self._line, node) or ast.unparse(node)
            raise ExpressionError(f"{quoted(written)} divides by zero")
        return _value(_OPERATORS[type(node.op)], values)

    @staticmethod
    def _constant(node: ast.Constant) -> float:
        """Make a number a float: whole ones could grow without bounds, and slowly."""
        if isinstance(node.value, str):
            raise ExpressionError(f"{quoted(node.value)} is text; text can only be compared, with a captured chunk")
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            raise _refusal(node)
        try:
            node.value = float(node.value)
        except OverflowError:
            raise ExpressionError("holds a number that is too large") from None
        return node.value

    def _name(self, name: str) -> float | None:
        if name in FUNCTIONS:
            raise ExpressionError(f"{name} is a function: write {name}(…)")
        if name in self._known:
            self.names.add(name)
        elif name not in CONSTANTS:
            what = hint(name, self._known) or " (this type has no features)"
            raise ExpressionError(f"unknown feature {quoted(name)}{what}")
        return self._known.constants.get(name, CONSTANTS.get(name))

    def _compares_text(self, node: ast.Compare) -> bool:
        """Whether text is compared: there is some, or there is nothing but captured chunks."""
        sides = (node.left, *node.comparators)
        chunks = all(isinstance(side, ast.Name) and side.id in self._known.captures for side in sides)
        return any(map(_is_text, sides)) or (chunks and set(map(type, node.ops)) <= {ast.Eq, ast.NotEq})

    def _texts(self, node: ast.Compare) -> None:
        """Take captured chunks as the text that they are compared with."""
        if not set(map(type, node.ops)) <= {ast.Eq, ast.NotEq}:
            raise ExpressionError(f"{quoted(ast.unparse(node))} orders text; text can only be compared by == and !=")
        for side in (node.left, *node.comparators):
            if isinstance(side, ast.Name) and side.id in self._known.captures:
                self.names.add(side.id)
                side.id = as_text(side.id)
            elif not _is_text(side):
                if isinstance(side, ast.Name):
                    self._name(side.id)
                what = f"{quoted(ast.unparse(side))} is a number, not text"
                raise ExpressionError(f"{what}; text can only be compared with a captured chunk")

    def _call(self, name: str, arguments: int) -> None:
        if name in self._known:
            raise ExpressionError(f"{name} is no function; write {name} * (…) to multiply")
        if name not in FUNCTIONS:
            raise ExpressionError(f"unknown function {quoted(name)}" + hint(name, FUNCTIONS))
        _, least, most = FUNCTIONS[name]
        if not least <= arguments <= most:
            wanted = f"{least}" if least == most else f"at least {least}"
            raise ExpressionError(f"{name} takes {wanted} argument{'s' if least > 1 else ''}, not {arguments}")


def _value(function: Callable[..., float], arguments: list[float | None]) -> float | None:
    """Return the value for arguments that are all known; None where one is not, or where there is none."""
    if None in arguments:
        return None
    try:
        return float(function(*arguments))
    except (ArithmeticError, ValueError):
        return None


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _known(node: ast.Compare | ast.BoolOp | ast.IfExp) -> bool:
    return not isinstance(node, ast.Compare) or all(type(op) in _OPERATORS for op in node.ops)


def _refusal(node: ast.expr) -> ExpressionError:
    return ExpressionError(f"{quoted(ast.unparse(node))} is not arithmetic; {_ALLOWED}")
