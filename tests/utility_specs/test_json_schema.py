"""The JSON Schema that editors get."""

import json
import tomllib
from pathlib import Path

import pytest

from tests.utility_specs.bad_specs import GOOD
from utility_specs.json_schema import json_schema

SCHEMA = json_schema()
SURVEILLANCE = (Path(__file__).parents[2] / "utility_specs" / "surveillance.toml").read_text()


def resolved(schema):
    return SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]] if "$ref" in schema else schema


def tables():
    return {"the file": SCHEMA, **SCHEMA["$defs"]}


@pytest.mark.parametrize("table", [name for name, table in tables().items() if "properties" in table])
def test_every_key_is_explained(table):
    """An editor shows it when the key is written."""
    for name, key in tables()[table]["properties"].items():
        assert key.get("description") or resolved(key).get("description"), f"{table}.{name} has no description"


def test_there_is_nothing_in_it_that_toml_does_not_have():
    """No null, whatever Python makes of what is left out."""
    assert "null" not in json.dumps(SCHEMA)


def test_every_definition_is_used_and_every_reference_is_defined():
    """It stands alone."""
    text = json.dumps(SCHEMA)
    for name in SCHEMA["$defs"]:
        assert f'"#/$defs/{name}"' in text
    assert text.count('"$ref"') == sum(text.count(f'{{"$ref": "#/$defs/{name}"') for name in SCHEMA["$defs"]) + sum(
        text.count(f', "$ref": "#/$defs/{name}"') for name in SCHEMA["$defs"]
    )


TYPES = {
    "object": dict,
    "array": list,
    "string": str,
    "number": int | float,
    "integer": int,
    "boolean": bool,
}


def accepts(schema, value):
    """Whether the parts of JSON Schema that are used here accept the value."""
    schema = resolved(schema)
    choices = [schema[word] for word in ("anyOf", "oneOf") if word in schema]
    if not all(any(accepts(each, value) for each in choice) for choice in choices):
        return False
    if value not in schema.get("enum", [schema.get("const", value)]):
        return False
    kind = schema.get("type")
    if kind is not None and (not isinstance(value, TYPES[kind]) or isinstance(value, bool) > (kind == "boolean")):
        return False
    if isinstance(value, list):
        return all(accepts(schema.get("items", {}), each) for each in value)
    return not isinstance(value, dict) or accepts_keys(schema, value)


def accepts_keys(schema, table):
    known, rest = schema.get("properties", {}), schema.get("additionalProperties", {})
    if not table.keys() >= set(schema.get("required", ())) or (rest is False and table.keys() - known.keys()):
        return False
    return all(accepts(known.get(key, rest), value) for key, value in table.items())


@pytest.mark.parametrize("text", [GOOD, SURVEILLANCE])
def test_it_accepts_good_specs(text):
    """What the loader takes is not marked as wrong."""
    assert accepts(SCHEMA, tomllib.loads(text))


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("weight", "wieght"),
        ("[[constraint]]", "[[constraints]]"),
        ('"throughput"', '"thruput"'),
        ('"video"', '"linear"'),
        ('["robot/*/camera"]', '"robot/*/camera"'),
        ('"most_recent"', '"mean"'),
        ('limit = "2 Mbit/s"', "limit = 2"),
    ],
)
def test_it_refuses_what_an_editor_can_see(right, wrong):
    """Keys, kinds, choices and types; the loader judges the rest."""
    assert not accepts(SCHEMA, tomllib.loads(GOOD.replace(right, wrong, 1)))
