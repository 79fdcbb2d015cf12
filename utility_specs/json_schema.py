"""The JSON Schema of a spec file, for editors: they complete keys, explain them and mark what is wrong."""

from collections.abc import Iterator
from typing import Any

from utility_specs.schema import SpecFile

MEANINGS = {
    ("most_recent", "best", "sum", "once", "current"): (
        "What the sample received last is worth; a newer one supersedes one that waits.",
        "The greatest worth of all that were received.",
        "All that were received, added up.",
        "What the sample received first is worth; nothing after it counts.",
        "What the sample received last is worth, less what it shows in excess of the newest one made, sent or not.",
    ),
    ("last", "mean", "trend", "auto"): (
        "As in the last sample.",
        "The mean of the last 16.",
        "On the straight line through the last 8.",
        "What whichever of the others erred least lately says.",
    ),
    ("pass", "shadow", "enforce"): (
        "Samples pass without a decision.",
        "Decisions are made, counted and explained, and all samples pass.",
        "What is decided is done.",
    ),
    ("bypass", "decide"): ("Deletes always pass.", "The planner decides on them as on samples without a payload."),
    ("pass", "drop"): ("Queries cross.", "Queries that lie within these keys do not cross, either way."),
    ("adhoc", "infrastructure", "wired"): (
        "Robots hear each other.",
        "Through an access point: every frame crosses the air twice.",
        "The radio link is elsewhere; frames have no overhead of Wi-Fi.",
    ),
    ("unicast", "multicast"): ("A copy for each robot that wants it.", "One copy for all."),
    ("length", "min", "max", "mean", "sum"): (
        "How many elements there are.",
        "The least of them.",
        "The greatest of them.",
        "Their mean.",
        "Their sum.",
    ),
    ("real_time", "interactive_high", "interactive_low", "data_high", "data", "data_low", "background"): tuple(
        f"Zenoh's priority {number}{what}."
        for number, what in enumerate((", the highest", *[""] * 5, ", the lowest"), 1)
    ),
}
"""What the words of a choice mean, in the order of the schema."""

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """Return the schema, with a description for every key. TOML knows no null, so there is none in it."""
    schema = SpecFile.model_json_schema()
    for table in (schema, *schema["$defs"].values()):
        for name, key in table.get("properties", {}).items():
            if name == "kind":
                key["description"] = table["description"]
    for part in list(_parts(schema)):
        _simplify(part)
    return {"$schema": DIALECT} | schema | {"title": "Sendworthy utility spec"}


def _parts(node: Any, *, named: bool = False) -> Iterator[dict[str, Any]]:
    """Yield every schema in a schema, inner ones first; `named` ones are in a table by what people call them."""
    if isinstance(node, dict):
        for key, each in node.items():
            yield from _parts(each, named=not named and key in {"properties", "$defs"})
        if not named:
            yield node
    elif isinstance(node, list):
        for each in node:
            yield from _parts(each)


def _simplify(part: dict[str, Any]) -> None:
    """Drop what only Python knows: null, titles made of names, and defaults that nobody would write so."""
    if isinstance(part.get("title"), str):
        del part["title"]
    forms = [form for form in part.get("anyOf", ()) if form != {"type": "null"}]
    if len(forms) == 1:
        del part["anyOf"]
        part |= forms[0] | part
    elif forms:
        part["anyOf"] = forms
    if (meanings := MEANINGS.get(tuple(part.get("enum", ())))) is not None:
        part["x-taplo"] = {"docs": {"enumValues": list(meanings)}}
    default = part.get("default")
    quantity = part.get("type") == "string" and isinstance(default, float)
    if default is None or quantity or isinstance(default, dict | list):
        part.pop("default", None)
