"""The JSON Schema of a spec file, for editors: they complete keys, explain them and mark what is wrong."""

from collections.abc import Iterator
from typing import Any

from utility_specs.schema import SpecFile

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


def _parts(node: Any) -> Iterator[dict[str, Any]]:
    """Yield every object of a schema, inner ones first."""
    inside = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    for each in inside:
        yield from _parts(each)
    if isinstance(node, dict):
        yield node


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
    default = part.get("default")
    quantity = part.get("type") == "string" and isinstance(default, float)
    if default is None or quantity or isinstance(default, dict | list):
        part.pop("default", None)
