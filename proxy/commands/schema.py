"""`sendworthy schema`: prints what an editor needs to complete utility specs."""

import argparse
import json

from proxy import exit_codes
from utility_specs.json_schema import json_schema

DESCRIPTION = """\
Prints the JSON Schema of utility specs. Editors that know TOML schemas (Taplo, and Even Better TOML for VS Code)
complete and explain every key with it, when a spec begins with `#:schema FILE`.
"""
EXAMPLES = """\
examples:
  sendworthy schema > specs.d/sendworthy.schema.json
  sed -i '1i #:schema ./sendworthy.schema.json' specs.d/camera.toml
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "schema",
        help="print the JSON Schema of utility specs, for editors",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)


def run(_arguments: argparse.Namespace) -> int:
    """Print it; return the exit code."""
    print(json.dumps(json_schema(), indent=2))
    return exit_codes.OK
