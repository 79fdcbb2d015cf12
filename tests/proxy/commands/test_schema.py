"""`sendworthy schema`."""

import json

from proxy import exit_codes
from proxy.cli import main
from utility_specs.json_schema import json_schema


def test_the_schema_is_printed_as_json(capsys):
    """Ready to be put into a file."""
    assert main(["schema"]) == exit_codes.OK
    assert json.loads(capsys.readouterr().out) == json_schema()
