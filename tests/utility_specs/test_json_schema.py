"""The JSON Schema that editors get."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from pydantic import BaseModel

from tests.fuzz.spec_target import RICH
from tests.utility_specs.bad_specs import GOOD
from utility_specs.json_schema import MEANINGS, json_schema
from utility_specs.schema import SpecFile

SCHEMA = json_schema()
FOLDER = Path(__file__).parents[2] / "utility_specs"
READY_MADE = {path.name: path.read_text() for path in sorted(FOLDER.glob("*.toml"))}
EXAMPLES = re.findall(r"```toml\n(?!#:)(.*?)```", (FOLDER / "README.md").read_text(), re.DOTALL)
NAMES = {"red", "humble", "compressed", "json", "little"}
"""The first words of choices that explain themselves."""


def resolved(schema):
    return SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]] if "$ref" in schema else schema


def tables():
    return {"the file": SCHEMA, **SCHEMA["$defs"]}


@pytest.mark.parametrize("table", [name for name, table in tables().items() if "properties" in table])
def test_every_key_is_explained(table):
    """An editor shows it when the key is written."""
    for name, key in tables()[table]["properties"].items():
        assert key.get("description") or resolved(key).get("description"), f"{table}.{name} has no description"


def enums(node):
    """Yield all choices of words."""
    inside = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    for each in inside:
        yield from enums(each)
    if isinstance(node, dict) and isinstance(words := node.get("enum"), list) and isinstance(words[0], str):
        yield node


def test_every_choice_is_explained():
    """Word by word, as Taplo shows it; names of colours and formats are not."""
    found = list(enums(SCHEMA))
    explained = [each for each in found if each["enum"][0] not in NAMES]
    assert {tuple(each["enum"]) for each in explained} == MEANINGS.keys()
    for each in explained:
        assert len(each["x-taplo"]["docs"]["enumValues"]) == len(each["enum"])


def described(model):
    """Yield all keys of a table of the format, with the schema of each."""
    table = SCHEMA if model is SpecFile else SCHEMA["$defs"][model.__name__]
    for name, field in model.model_fields.items():
        yield f"{model.__name__}.{name}", field, table["properties"][name]


def models(base=BaseModel):
    for each in base.__subclasses__():
        if each.__module__.startswith("utility_specs") and (each is SpecFile or each.__name__ in SCHEMA["$defs"]):
            yield each
        yield from models(each)


@pytest.mark.parametrize("model", sorted(set(models()), key=lambda each: each.__name__))
def test_defaults_are_told(model):
    """As values, or where there are none, in words; tables that may be left out are empty then."""
    for where, field, key in described(model):
        if not field.is_required() and isinstance(field.default, bool | int | float | str):
            said = key.get("default") == field.default or "unless" in key["description"]
            assert said, f"the default of {where}"


def test_the_schema_beside_the_ready_made_specs_is_this_one():
    """`sendworthy schema > utility_specs/sendworthy.schema.json` makes it; their first lines name it for editors."""
    assert json.loads((FOLDER / "sendworthy.schema.json").read_text()) == SCHEMA
    assert all(text.startswith("#:schema ./sendworthy.schema.json\n") for text in READY_MADE.values())


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


@pytest.mark.parametrize("text", [GOOD, RICH, *READY_MADE.values(), *EXAMPLES])
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
