"""`sendworthy schema`."""

import json

from proxy import exit_codes
from proxy.cli import main
from proxy.status.model import json_schema as status_schema
from utility_specs.json_schema import json_schema


def test_the_schema_is_printed_as_json(capsys):
    """Ready to be put into a file."""
    assert main(["schema"]) == exit_codes.OK
    assert json.loads(capsys.readouterr().out) == json_schema()


def test_the_schema_of_the_status_is_another_one(capsys):
    """By its name."""
    assert main(["schema", "status"]) == exit_codes.OK
    assert json.loads(capsys.readouterr().out) == status_schema()
