"""The schema of a spec file, as tools see it."""

from utility_specs.schema import SpecFile


def test_the_schema_can_be_handed_to_editors():
    """It is a JSON Schema that knows every table and refuses unknown keys."""
    schema = SpecFile.model_json_schema()
    assert set(schema["properties"]) == {
        "version",
        "floor",
        "fallback",
        "constants",
        "constraint",
        "information_type",
    }
    assert all(table["additionalProperties"] is False for table in schema["$defs"].values())


def test_quantities_are_strings_to_an_editor():
    """Limits are written with units, durations with or without."""
    table = SpecFile.model_json_schema()["$defs"]["ThroughputTable"]["properties"]
    assert table["limit"]["type"] == "string"
    assert [form["type"] for form in table["window"]["anyOf"]] == ["number", "string"]
