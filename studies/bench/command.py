"""`sendworthy bench`: flies policies through missions that are files, and prints what they reach."""

import argparse
import os
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.extras import needs
from proxy.printable import clean
from studies.given import reason_of
from utility_specs.errors import QuantityError, SpecsError
from utility_specs.units import DURATION

DESCRIPTION = """\
Flies policies through the missions of the benchmark and prints what each reaches: utility as a part of the offline
bound, how much it sent, how much of that exceeded a limit (the channel refuses it, and the score is less by as much),
and how long decisions took. Sendworthy's own modes fly beside simpler policies.

A policy of your own is a Python class with one method, decide(self, sample, situation), which returns whether to send a
sample that its robot generated just now. studies/bench/README.md has an example of ten lines, the rules, and the format
of missions.

Missions come with Sendworthy, drawn ones and a recorded one. --generate writes the drawn ones anew, --make writes one
of a recording. Both need the extra study, and --make the extra record.
"""
EXAMPLES = """\
examples:
  sendworthy bench                                          all missions, all policies; takes some minutes
  sendworthy bench --policy mine.py:Faded                   and one of yours
  sendworthy bench --only --policy mine.py:Faded --policy best --missions paper-few traffic-mixed
  sendworthy bench --missions my.jsonl --json scores.json
  sendworthy bench --list
  sendworthy bench --make my.jsonl --recording r1.mcap r2.mcap    a mission of what daemons recorded

exit codes:
  0  it is printed, or written
  1  a mission cannot be read, a policy cannot be found or fails, a recording cannot be used
  78 the specs are wrong
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "bench",
        help="fly policies through the missions of the benchmark, and score them",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("--policy", metavar="NAME", action="append", default=[], help="module:Class, file.py:Class or one of ours")
    add("--only", action="store_true", help="fly the policies named by --policy, and no others")
    add("--missions", metavar="MISSION", nargs="+", help="names of ours, or files of yours (default: all of ours)")
    add("--jobs", metavar="N", type=_count, default=os.cpu_count() or 1, help="processes (default: one a core)")
    add("--json", metavar="FILE", type=Path, help="write the scores here; - is standard output")
    add("--leaderboard", metavar="FILE", type=Path, help="write the scores here, as a Markdown page")
    add("--list", action="store_true", help="print which missions and policies there are, and end")
    add("--generate", metavar="FOLDER", type=Path, help="write the drawn missions here, with SHA256SUMS, and end")
    add("--make", metavar="FILE", type=Path, help="write a mission of a recording here, and end")
    add("--recording", metavar="FILE", nargs="+", type=Path, help="of --make: all parts of one, or those of robots")
    add("--specs", metavar="PATH", action="append", type=Path, help="of --make: specs instead of the recorded ones")
    add("--about", metavar="TEXT", help="of --make: what it is, in a line")
    add("--latency", metavar="TIME", type=_duration, default=0.02, help="of --make: between robots (default: 20 ms)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Do what was asked for; return the exit code."""
    from studies.bench import doing  # noqa: PLC0415 - takes a second
    from studies.bench.errors import BenchError  # noqa: PLC0415
    from studies.oracle import OracleError  # noqa: PLC0415

    try:
        doing.bench(arguments)
    except doing.RecordMissingError:
        print(f"sendworthy bench: --make {needs('record')}", file=sys.stderr)
        return exit_codes.FAILED
    except (BenchError, OracleError) as error:
        return _failed(str(error))
    except OSError as error:
        return _failed(reason_of(error))
    except SpecsError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG
    return exit_codes.OK


def _failed(reason: str) -> int:
    print(clean(f"sendworthy bench: {reason}"), file=sys.stderr)
    return exit_codes.FAILED


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 256:
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1 to 256")
    return int(text)


def _duration(text: str) -> float:
    try:
        return DURATION.parse(text)
    except QuantityError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
