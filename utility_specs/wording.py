"""What pydantic says about wrong data, put into words for someone who edits a file."""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Self

from pydantic_core import ErrorDetails

from utility_specs.suggestions import described, hint, listed, quoted

Schema = Mapping[str, Any]
"""A JSON Schema, or a part of one."""

_EXPECTED = {
    "string_type": "a string",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "list_type": "an array",
    "tuple_type": "an array",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "finite_number": "a finite number",
}
_BOUNDS = {
    "greater_than": ("more than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}


@dataclass(frozen=True, slots=True)
class Place:
    """Where an error is: its key path, the keys known beside the last one, the kinds known there.

    `repeats` says that an array of tables belongs there.
    """

    path: tuple[str | int, ...]
    siblings: tuple[str, ...] = ()
    kinds: tuple[str, ...] = ()
    repeats: bool = False

    @classmethod
    def find(cls, schema: Schema, loc: tuple[str | int, ...], error: str) -> Self:
        """Follow pydantic's location through the schema: it holds the tags of unions, which no file does."""
        path: list[str | int] = []
        node: Schema | None = schema
        siblings: tuple[str, ...] = ()
        for part in loc:
            if part == "[key]":
                continue
            branch = _branch(schema, node, part)
            if branch is not None:
                node = branch
                continue
            siblings = tuple(_properties(schema, node))
            node = _child(schema, node, part)
            path.append(part)
        kinds = tuple(_mapping(schema, node))
        if error in {"union_tag_invalid", "union_tag_not_found"}:
            path.append("kind")
        item = _child(schema, node, 0)
        repeats = any(_properties(schema, item)) or bool(_mapping(schema, item))
        return cls(tuple(path), siblings, kinds, repeats)


def message_of(detail: ErrorDetails, place: Place) -> str:
    """Return what is wrong and what would be right, without the place."""
    kind, value, context = detail["type"], detail["input"], detail.get("ctx", {})
    if kind in _EXPECTED:
        wanted = _EXPECTED[kind]
        write = _rewritten(wanted, value, place)
        return f"must be {write}" if write else f"must be {wanted}, not {described(value)}"
    if kind in _BOUNDS:
        words, bound = _BOUNDS[kind]
        return f"must be {words} {_round(context[bound])}, not {described(value)}"
    if kind in _OTHERS:
        return _OTHERS[kind](value, context, place)
    message = detail["msg"]
    return message[:1].lower() + message[1:]


def _round(bound: float) -> str:
    """Return a bound, which is a plain number, without the .0 that it may have."""
    return f"{bound:g}" if isinstance(bound, float) else str(bound)


def _rewritten(wanted: str, value: Any, place: Place) -> str:
    """Return how a value of a wrong form is to be written, where that can be told."""
    name = ".".join(map(str, place.path))
    if wanted == "an array" and isinstance(value, dict) and place.repeats:
        return f"an array of tables: write [[{name}]] instead of [{name}]"
    if wanted == "an array" and isinstance(value, str):
        return _as_array(value)
    if wanted == "a table" and isinstance(value, list) and value and isinstance(value[0], dict):
        return f"one table: write [{name}] instead of [[{name}]]"
    if wanted == "a table" and value in place.kinds:
        return f"a table: write {{ kind = {quoted(value)} }} instead of {quoted(value)}"
    return ""


def _as_array(text: str) -> str:
    """Return how text in place of an array is to be written. Shells take the quotes out of one that is not quoted."""
    bare = text.startswith("[") and text.endswith("]") and not text.startswith("[[")
    items = text[1:-1].split(",") if bare else [text]
    array = ", ".join(quoted(item.strip()) for item in items)
    quoting = ", on a command line between single quotes" if bare else ""
    return f"an array: write [{array}] instead of {quoted(text)}{quoting}"


def _unknown_key(_value: Any, _context: Mapping[str, Any], place: Place) -> str:
    return "unknown key" + hint(str(place.path[-1]), place.siblings, "known keys")


def _unknown_kind(_value: Any, context: Mapping[str, Any], place: Place) -> str:
    word = str(context["tag"])
    return f"unknown kind {quoted(word)}" + hint(word, place.kinds)


def _no_kind(_value: Any, _context: Mapping[str, Any], place: Place) -> str:
    return f"is missing (one of {listed(place.kinds)})"


def _unknown_choice(value: Any, context: Mapping[str, Any], place: Place) -> str:
    """Word a value that is none of those that a `Literal` or an enumeration allows."""
    words = re.findall(r"'(.*?)'", str(context["expected"]))
    if not isinstance(value, str) or not words:
        return f"must be {listed(words) or context['expected']}, not {described(value)}"
    what = "kind " if place.path[-1] == "kind" else ""
    return f"unknown {what}{quoted(value)}" + hint(value, words)


def _own(_value: Any, context: Mapping[str, Any], _place: Place) -> str:
    """Word an error that one of our own validators raised."""
    return str(context["error"])


def _too_long(_value: Any, context: Mapping[str, Any], _place: Place) -> str:
    actual = context.get("actual_length")
    return f"must hold at most {context['max_length']} values" + (f", not {actual}" if actual else "")


_OTHERS: dict[str, Callable[[Any, Mapping[str, Any], Place], str]] = {
    "missing": lambda _value, _context, _place: "is missing",
    "extra_forbidden": _unknown_key,
    "union_tag_invalid": _unknown_kind,
    "union_tag_not_found": _no_kind,
    "literal_error": _unknown_choice,
    "enum": _unknown_choice,
    "value_error": _own,
    "assertion_error": _own,
    "too_long": _too_long,
    "too_short": lambda _value, _context, _place: "must not be empty",
    "string_too_short": lambda _value, _context, _place: "must not be empty",
}


def _resolved(root: Schema, node: Schema | None) -> Schema:
    """Follow a reference to the definition that it names."""
    while node is not None and "$ref" in node:
        node = root["$defs"][str(node["$ref"]).rsplit("/", 1)[-1]]
    return node or {}


def _alternatives(root: Schema, node: Schema | None) -> Iterator[Schema]:
    """Yield the node itself and all that `anyOf` allows in its place (an optional table is one)."""
    node = _resolved(root, node)
    yield node
    for alternative in node.get("anyOf", ()):
        yield from _alternatives(root, alternative)


def _properties(root: Schema, node: Schema | None) -> Iterator[str]:
    for alternative in _alternatives(root, node):
        yield from alternative.get("properties", ())


def _mapping(root: Schema, node: Schema | None) -> dict[str, Schema]:
    """Return the kinds of a union that is told apart by `kind`, each with its schema; empty for all else."""
    mapping: dict[str, Schema] = {}
    for alternative in _alternatives(root, node):
        references = alternative.get("discriminator", {}).get("mapping", {})
        mapping |= {kind: {"$ref": reference} for kind, reference in references.items()}
    return mapping


def _branch(root: Schema, node: Schema | None, part: str | int) -> Schema | None:
    """Return the alternative that a tag of pydantic's location names; None when `part` is a key.

    Where alternatives are told apart by their form, the schema does not say which one a tag means: it may be any.
    """
    plain = _resolved(root, node)
    if "oneOf" in plain and "discriminator" not in plain:
        return {"anyOf": plain["oneOf"]}
    return _mapping(root, node).get(str(part))


def _child(root: Schema, node: Schema | None, part: str | int) -> Schema | None:
    """Return the schema of a table's key or of an array's items."""
    for alternative in _alternatives(root, node):
        inside = alternative.get("items") if isinstance(part, int) else alternative.get("properties", {}).get(part)
        more = alternative.get("additionalProperties")
        if inside is None and isinstance(part, str) and isinstance(more, Mapping):
            inside = more
        if isinstance(inside, Mapping):
            return inside
    return None
