"""`sendworthy explain`: why a sample is worth what it is, by the specs alone or as the daemon here sees it."""

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import msgpack
import zenoh

from proxy import exit_codes
from proxy.bridge.tuning import TUNING
from proxy.commands.client import Client, NoAnswerError, add_client_flags, connected
from proxy.errors import ProxyError
from proxy.explanation_text import described, ranking
from proxy.live_streams import competing, known, live_data, streams_of
from proxy.printable import clean
from proxy.quantities import Status
from utility_specs import Specs, SpecsError
from utility_specs.competing import Competitor, competitors, typical_sizes
from utility_specs.errors import QuantityError
from utility_specs.explaining import Explanation, explain
from utility_specs.features.change import Change
from utility_specs.loader import SpecSet, load_set, spec_files
from utility_specs.suggestions import hint, quoted
from utility_specs.terminal_plot import ASCII, BRAILLE, Style
from utility_specs.units import DURATION, SIZE, Dimension

DESCRIPTION = """\
Says why a sample is worth what it is: which information type covers its key, the value of each feature and why one has
its default, weight and scale with the numbers put in, the utility over age, what the sample takes of each limit, and
what it competes with. Without a PAYLOAD the defaults of all features hold.

With --live the next sample of KEY is taken from the daemon, which needs no PAYLOAD, and what the daemon knows of its
stream comes with it: its schedule, what became of its samples, the last decision, and the streams it competes with. The
daemon takes us for an application that subscribes to KEY; if no other one does, samples of KEY on other robots are
wanted here for as long as we wait.

What was decided on the last samples of a stream, and why, `sendworthy why KEY` tells.
"""
EXAMPLES = """\
examples:
  sendworthy explain --specs specs.d robot/r1/camera image.jpg
  sendworthy explain --specs specs.d robot/r1/battery --text '{"charge": 0.1}'
  sendworthy explain --specs specs.d robot/r1/camera --size "40 kB" --size "battery=60 B"
  sendworthy explain --live robot/r1/camera
  sendworthy explain --live 'robot/*/camera' --timeout "10 s" --json

The exit code is 0 when the sample is explained, also where no type covers its key; 1 when the specs are wrong, a file
cannot be read, no daemon answers or no sample comes; 2 for a wrong command line.
"""
TIMEOUT = 5.0
"""How long the next sample is waited for [s]."""
LOOKS, PAUSE = 10, 0.1
"""How often the daemon is asked whether it has decided on the sample, and the time between [s]."""
TYPED = str.maketrans({"×": "x", "μ": "u", "…": "...", "±": "+-"})
"""What stands for other characters where there is only ASCII."""


class ExplainError(ProxyError):
    """What was asked for cannot be explained; says why."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "explain",
        help="say why a sample is worth what it is",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("key", metavar="KEY", help="the key of the sample; with --live a key expression")
    payload = parser.add_mutually_exclusive_group()
    payload.add_argument("payload", metavar="PAYLOAD", nargs="?", help="a file with the payload; - is standard input")
    payload.add_argument("--text", metavar="TEXT", help="the payload as text, such as JSON")
    payload.add_argument("--msgpack", metavar="JSON", help="the payload as JSON, which is packed as MessagePack")
    payload.add_argument("--live", action="store_true", help="take the next sample from the daemon")
    parser.add_argument("--attachment", metavar="FILE", help="a file with the attachment of the sample")
    parser.add_argument(
        "--specs",
        metavar="FILE",
        type=Path,
        action="append",
        help="a file or a folder of *.toml, any number of times (default: what the daemon here has)",
    )
    parser.add_argument(
        "--size",
        metavar="[TYPE=]SIZE",
        type=_size,
        action="append",
        default=[],
        help='the size of the sample if not that of the payload, such as "40 kB", or of samples of another type',
    )
    parser.add_argument(
        "--receivers",
        metavar="N",
        type=_count,
        help="how many robots get a copy (default: 1, or what the daemon knows)",
    )
    parser.add_argument(
        "--timeout", metavar="TIME", type=_time, default=TIMEOUT, help="how long to wait for a sample (default: 5 s)"
    )
    parser.add_argument("--ascii", action="store_true", help="draw with plain characters")
    parser.add_argument("--json", action="store_true", help="the same as JSON")
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Explain and print; return the exit code."""
    if arguments.live and (arguments.attachment or arguments.size):
        print("sendworthy explain: with --live the sample has its own size and attachment", file=sys.stderr)
        return exit_codes.USAGE
    try:
        if arguments.live or not arguments.specs:
            with connected(arguments.connect) as daemon:
                status = daemon.status(arguments.robot or daemon.only_robot())[0]
                specs = load_set(arguments.specs or [_path_of_specs(status)])
                lines = (
                    _live(arguments, specs, daemon, status) if arguments.live else _offline(arguments, specs, status)
                )
        else:
            lines = _offline(arguments, load_set(arguments.specs), None)
    except (NoAnswerError, ExplainError, OSError) as error:
        print(clean(f"sendworthy explain: {error}"), file=sys.stderr)
        return exit_codes.FAILED
    except SpecsError as error:
        print(error, file=sys.stderr)
        return exit_codes.FAILED
    plain = _style(arguments) is ASCII
    for line in lines:
        print(line if arguments.json else clean(line.translate(TYPED) if plain else line))
    return exit_codes.OK


def _offline(arguments: argparse.Namespace, specs: SpecSet, status: Status | None) -> list[str]:
    """Explain what is on the command line; the status is that of the daemon whose specs these are."""
    key = _checked(arguments.key)
    if "*" in key:
        raise ExplainError(f"{quoted(key)} stands for many keys; a sample has one of them")
    said = {name: size for name, size in arguments.size if name}
    types = [each.name for each in specs.specs.types]
    for name in said.keys() - set(types):
        raise ExplainError(f"--size: there is no information type {quoted(name)}{hint(name, types)}")
    sizes = typical_sizes(specs) | said
    given = next((size for name, size in arguments.size if not name), None)
    payload = _payload(arguments)
    if payload is None and given is None:
        of = specs.specs.match(key)
        given = None if of is None else sizes.get(of.name)
    explanation = explain(
        specs,
        key,
        payload or b"",
        _read(arguments.attachment) if arguments.attachment else None,
        size=None if given is None else round(given),
        receivers=arguments.receivers or 1,
    )
    rivals = competitors(specs, explanation, sizes)
    remark = _other_specs(status, specs) if status else []
    if arguments.json:
        return [_json(explanation, rivals, {"same_specs": not remark} if status else {})]
    lines = [*described(explanation, _style(arguments)), *remark, ""]
    if all(each.this for each in rivals):
        return [*lines, "no other type of these specs competes with it, only samples of its own"]
    what = "what it competes with" if explanation.worth else "what is decided on beside it"
    lines.append(f"{what}, by what its bytes are worth in the first second; others by their defaults")
    lines += ranking(rivals, "TYPE")
    if any(each.size is None for each in rivals):
        lines.append('sizes are those of forecast.size; or say --size "TYPE=50 kB"')
    return lines


def _live(arguments: argparse.Namespace, specs: SpecSet, daemon: Client, status: Status) -> list[str]:
    """Explain the next sample, with what the daemon knows of its stream."""
    with closing(daemon.samples(_checked(arguments.key), arguments.timeout)) as samples:
        sample = _taken(samples, specs)
    key = str(sample.key_expr)
    status = _decided(daemon, status, key)
    wanted = max((each.get("receivers", 0) for each in streams_of(status, key)), default=0)
    copies = arguments.receivers or wanted or 1
    explanation = explain(specs, key, sample.payload, sample.attachment, receivers=copies)
    rivals = competing(status, specs.specs, key)
    remark = _other_specs(status, specs)
    if arguments.json:
        return [_json(explanation, rivals, {"same_specs": not remark, "daemon": live_data(status, key)})]
    lines = [*described(explanation, _style(arguments)), "", *known(status, key), *remark]
    if rivals:
        what = "what it competes with" if explanation.worth else "what is decided on beside it"
        lines += ["", f"{what}, by what the bytes of last samples are worth in their first second"]
        lines += ranking(rivals, "STREAM")
    return lines


def _taken(samples: Iterator[zenoh.Sample], specs: SpecSet) -> zenoh.Sample:
    """Return the next sample, and the one after it where a feature compares the two. Raises ExplainError."""
    sample = next(samples)
    key = str(sample.key_expr)
    of = specs.specs.match(key)
    if of is None or not any(isinstance(feature, Change) for _, feature in of.features):
        return sample
    of.extract(key, sample.payload, sample.attachment)
    try:
        return next(each for each in samples if str(each.key_expr) == key)
    except NoAnswerError:
        raise ExplainError(f"{key} has a feature that compares two samples, and only one came in time") from None


def _decided(daemon: Client, status: Status, key: str) -> Status:
    """Return the status as soon as its last decision was one on the key, or after a while."""
    for look in range(LOOKS):
        time.sleep(PAUSE if look else 0.0)
        status = daemon.status(str(status["robot"]))[0]
        wanted = any(each.get("receivers") for each in streams_of(status, key))
        if live_data(status, key)["last_decision"] or status.get("mode") == "pass" or not wanted:
            break
    return status


def _path_of_specs(status: Status) -> Path:
    """Return where the specs of a daemon are, which may not have taken them up yet. Raises ExplainError, OSError."""
    robot, said = status["robot"], status.get("daemon", {}).get("specs")
    path = None if said is None else Path(said)
    there = path is not None and path.exists()
    if status.get("specs") == Specs.empty().generation and not (path and there and spec_files(path)):
        raise ExplainError(f"robot {robot} has no specs, so all samples pass at once; choose others with --specs")
    if path is None or not there:
        where = "are not known" if path is None else f"are in {path}, which is not on this machine"
        raise ExplainError(f"the specs of robot {robot} {where}; choose a copy with --specs")
    return path


def _other_specs(status: Status, specs: SpecSet) -> list[str]:
    """Say so where these specs are not those in force."""
    ours, theirs = specs.specs.generation, status.get("specs")
    if ours == theirs:
        return []
    where = ", ".join(str(file.path) for file in specs.files)
    return [f"robot {status['robot']} has other specs in force ({theirs}) than those read here ({ours}: {where})"]


def _json(explanation: Explanation, rivals: Sequence[Competitor], more: Mapping[str, Any]) -> str:
    data = explanation.data() | {"competitors": [each.data() for each in rivals], **more}
    return json.dumps(data, indent=2)


def _style(arguments: argparse.Namespace) -> Style:
    """Return what to draw with: Braille where the output can show it, and nobody minds."""
    try:
        BRAILLE.sample.encode(sys.stdout.encoding or "ascii")
    except UnicodeEncodeError:
        return ASCII
    return ASCII if arguments.ascii else BRAILLE


def _checked(key: str) -> str:
    """Return the key expression. Raises ExplainError where it is none."""
    try:
        return str(zenoh.KeyExpr.autocanonize(key))
    except UnicodeEncodeError:
        raise ExplainError(f"{quoted(key)} is not a key: it is not UTF-8") from None
    except zenoh.ZError:
        meant = f"; write {quoted(key.strip('/'))}" if key.strip("/") and key.strip("/") != key else ""
        raise ExplainError(
            f"{quoted(key)} is not a key: chunks with / between them, none of them empty{meant}"
        ) from None


def _payload(arguments: argparse.Namespace) -> bytes | None:
    """Return the payload, if one is given. Raises ExplainError where it cannot be read."""
    if arguments.text is not None:
        return bytes(os.fsencode(arguments.text))  # as it was typed, which need not be UTF-8
    if arguments.msgpack is not None:
        try:
            return bytes(msgpack.packb(json.loads(arguments.msgpack)))
        except (ValueError, OverflowError, RecursionError) as error:
            raise ExplainError(f"--msgpack: {quoted(arguments.msgpack)} is not JSON: {error}") from None
    return None if arguments.payload is None else _read(arguments.payload)


def _read(file: str) -> bytes:
    """Return what is in a file, or in standard input, if a sample may be so large. Raises ExplainError."""
    most = TUNING.largest_message
    try:
        if file == "-":
            data = sys.stdin.buffer.read(most + 1)
        else:
            with Path(file).open("rb") as opened:
                data = opened.read(most + 1)
    except (OSError, ValueError) as error:
        raise ExplainError(f"{file}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(data) > most:
        raise ExplainError(f"{file}: is larger than {most // 2**20} MiB, as no sample is that crosses the mesh")
    return data


def _size(text: str) -> tuple[str, float]:
    """Read `[TYPE=]SIZE` for argparse."""
    name, _, size = text.rpartition("=")
    return name.strip(), _quantity(SIZE, size)


def _time(text: str) -> float:
    """Read a time for argparse."""
    return _quantity(DURATION, text)


def _quantity(dimension: Dimension, text: str) -> float:
    try:
        return dimension.parse(text)
    except QuantityError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _count(text: str) -> int:
    """Read a number of robots for argparse."""
    if not text.isascii() or not text.isdecimal() or len(text) > 9 or int(text) == 0:
        raise argparse.ArgumentTypeError(f"must be a number of robots from 1 on, not {quoted(text)}")
    return int(text)
