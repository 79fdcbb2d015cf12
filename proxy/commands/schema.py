"""`sendworthy schema`: prints what an editor needs to complete utility specs, or what describes the status."""

import argparse
import json

from proxy import exit_codes
from proxy.status.model import json_schema as status_schema
from utility_specs.json_schema import json_schema

DESCRIPTION = """\
Prints the JSON Schema of utility specs. Editors that know TOML schemas (Taplo, and Even Better TOML for VS Code)
complete and explain every key with it, when a spec begins with `#:schema FILE`. `sendworthy schema status` prints that
of `sendworthy status --json` instead: every field with its meaning and its unit.
"""
EXAMPLES = """\
examples:
  sendworthy schema > specs.d/sendworthy.schema.json
  sed -i '1i #:schema ./sendworthy.schema.json' specs.d/camera.toml
  sendworthy schema status                         what `sendworthy status --json` says
"""

SCHEMAS = {"specs": json_schema, "status": status_schema}


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "schema",
        help="print the JSON Schema of utility specs, for editors, or of the status",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "what",
        nargs="?",
        choices=SCHEMAS,
        default="specs",
        help="of what (default: %(default)s)",
        metavar="specs|status",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print it; return the exit code."""
    print(json.dumps(SCHEMAS[arguments.what](), indent=2))
    return exit_codes.OK
