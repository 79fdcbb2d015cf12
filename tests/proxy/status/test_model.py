"""The format of the status in JSON."""

import json
from pathlib import Path

import pytest
from pydantic import ValidationError

from proxy.core.status import STATUS_VERSION
from proxy.status.model import Status, json_schema

ROOT = Path(__file__).parents[3]
RECORDED = [json.loads(file.read_text()) for file in sorted((Path(__file__).parent / "recorded").glob("*.json"))]
SCHEMA = json_schema()
NUMBERS = {"integer", "number"}


def tables():
    return {"the status": SCHEMA, **SCHEMA["$defs"]}


def types_in(field):
    """All types that values of a field, or what it holds, may have."""
    found = {field.get("type")}
    for each in (*field.get("anyOf", ()), field.get("items"), field.get("additionalProperties")):
        if isinstance(each, dict):
            found |= types_in(each)
    return found


def test_the_file_is_what_the_code_says():
    """Whoever changes the format sees it in the change; what goes or is renamed makes another version."""
    assert json.loads((ROOT / "docs" / "reference" / "status.schema.json").read_text()) == SCHEMA


@pytest.mark.parametrize("status", RECORDED)
def test_what_daemons_said_in_this_version_is_still_right(status):
    """Recorded from three that shared a channel too small for them."""
    assert status["status_version"] == STATUS_VERSION
    Status.model_validate(status)


@pytest.mark.parametrize("table", tables())
def test_every_field_is_explained_and_every_number_has_a_unit(table):
    """In the schema, where programs and people look."""
    assert tables()[table]["description"]
    for name, field in tables()[table]["properties"].items():
        assert field.get("description"), name
        if NUMBERS & types_in(field) or "const" in field:
            assert field.get("unit"), name


def test_a_field_that_is_not_described_is_refused_here_and_only_here():
    """Daemons say nothing else; programs with an older schema may meet it."""
    with pytest.raises(ValidationError, match="surprise"):
        Status.model_validate(RECORDED[0] | {"surprise": 1})
    assert '"additionalProperties": false' not in json.dumps(SCHEMA)


def test_a_field_that_is_missing_is_refused():
    """All are there always, but for those of features that are not in use."""
    with pytest.raises(ValidationError, match="uptime"):
        Status.model_validate({name: value for name, value in RECORDED[0].items() if name != "uptime"})
