"""`sendworthy learn`: writes a first utility spec from the traffic that is there."""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from proxy import exit_codes
from proxy.commands.client import Client, NoAnswerError, add_client_flags, connected
from proxy.commands.listening import MOST_BYTES, Listener
from proxy.commands.team import Status, notes_on, robots_of
from proxy.config_values import key_expression
from proxy.core.forecast.schedule import Schedule
from proxy.output import check_writable
from utility_specs import SpecsError, load_specs
from utility_specs.learning import LearningError, learn
from utility_specs.learning.recording import Reader, RecordingError, Writer
from utility_specs.learning.toml_text import counted
from utility_specs.toml_source import is_no_file

DESCRIPTION = """\
Listens at the daemon here for 30 s, or reads a recording, and writes a first utility spec: the information types there
are, how often and how large their samples are, which utility and aggregation suit them, and what in their payloads
could matter. What matters most, and what the channel carries, is left to you; the places are marked.

It subscribes to every key, as an application would: so other robots send this one everything they have, for as long as
it listens. Robots that decide already (mode enforce, with specs) show only what they send: switch them to shadow first.
It works at any Zenoh router, too. Ctrl-C ends listening, and what was heard until then counts.
"""
EXAMPLES = """\
examples:
  sendworthy learn                                   listen, and print a spec
  sendworthy learn -o specs.d/learned.toml           the same, to a file
  sendworthy learn --keys 'robot/**' --seconds 120   only these keys, for longer
  sendworthy learn --record traffic.rec              keep what was heard
  sendworthy learn traffic.rec                       learn from a recording

A daemon puts what is written to its folder of specs in force at once: `sendworthy mode shadow` before is wise.
"""


MOST = 1e9
"""Nobody listens for longer [s], or to more samples."""


class OutputError(Exception):
    """What was learned cannot be written where it should be."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "learn",
        help="write a first utility spec from traffic",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("recording", metavar="RECORDING", nargs="?", type=Path, help="a file of --record")
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="write to a file instead of printing")
    parser.add_argument("--force", action="store_true", help="replace the files of -o and --record if they exist")
    parser.add_argument("--record", metavar="FILE", type=Path, help="keep what is heard in a file")
    parser.add_argument("--seconds", metavar="N", type=_above_0, default=30.0, help="listen so long (default: 30)")
    parser.add_argument("--samples", metavar="N", type=_count, help="listen for so many samples at most")
    parser.add_argument(
        "--keys", metavar="EXPRESSION", action="append", type=_keys, help="listen to these keys only; may be repeated"
    )
    add_client_flags(parser)
    parser.set_defaults(run=run)


def _above_0(text: str) -> float:
    """Read a number above 0 for argparse; infinite ones and their kin are none."""
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0.0 < number < MOST:
        raise argparse.ArgumentTypeError(f'must be a number above 0, not "{text}"')
    return number


def _count(text: str) -> int:
    return max(1, round(_above_0(text)))


def _keys(text: str) -> str:
    try:
        return key_expression(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def run(arguments: argparse.Namespace) -> int:
    """Learn and write; return the exit code."""
    if arguments.recording is not None and arguments.record is not None:
        print("sendworthy learn: give it a RECORDING or --record, not both", file=sys.stderr)
        return exit_codes.USAGE
    try:
        for path in filter(None, (arguments.output, arguments.record)):
            _check_free(path, force=arguments.force, replaced=path is arguments.output)
        text = _of_recording(arguments.recording) if arguments.recording else _of_live(arguments)
        _check(text)
        if arguments.output is None:
            print(text, end="")
        else:
            _write(text, arguments.output)
    except (LearningError, NoAnswerError, OutputError, RecordingError) as error:
        print(f"sendworthy learn: {error}", file=sys.stderr)
        return exit_codes.FAILED
    return exit_codes.OK


def _of_recording(path: Path, notes: Sequence[str] = ()) -> str:
    """Learn from a recording; say what of it could not be read. Raises LearningError or RecordingError."""
    try:
        with path.open("rb") as file:
            reader = Reader(file)
            text = learn(reader, Schedule, reader.robots, partial(_and_damage, notes, reader))
    except OSError as error:
        meant = f"; to write a spec to it, say -o {path}" if path.suffix == ".toml" else ""
        raise RecordingError(f"{path} cannot be read: {error.strerror}{meant}") from None
    except RecordingError as error:
        raise RecordingError(f"{path} {error}") from None
    if reader.damage:
        print(f"sendworthy learn: {path}: {reader.damage}", file=sys.stderr)
    return text


def _and_damage(notes: Sequence[str], reader: Reader) -> list[str]:
    """Add to the notes, once all is read, what of it could not be."""
    return [*notes, f"{reader.damage[0].upper()}{reader.damage[1:]}."] if reader.damage else list(notes)


def _of_live(arguments: argparse.Namespace) -> str:
    """Learn from what is heard. Raises NoAnswerError, LearningError or OutputError."""
    with ExitStack() as opened:
        daemon = opened.enter_context(connected(arguments.connect))
        statuses = _statuses(daemon, arguments.robot)
        with daemon.understood():
            robots, notes = robots_of(statuses), notes_on(statuses)
        add = None
        if arguments.record is not None:
            add = opened.enter_context(_recording(arguments.record, robots)).add
        listener = Listener(arguments.samples, add)
        print(f"listening at {arguments.connect} for {arguments.seconds:g} s", file=sys.stderr)
        with suppress(KeyboardInterrupt), daemon.listening(arguments.keys or ["**"], listener.take):
            listener.over.wait(arguments.seconds)
        listener.stop()
        if listener.failure is not None:
            raise listener.failure
    print(f"heard {counted(listener.count, 'sample')}", file=sys.stderr)
    if not listener.count:
        raise LearningError(f"nothing was published at {arguments.connect}; are the applications connected there?")
    if arguments.record is not None:
        return _of_recording(arguments.record, notes)
    if listener.full:
        early = f"Listening ended early, with {MOST_BYTES // 2**20} MiB; --record takes more, --keys only a part."
        notes.append(early)
        print(f"sendworthy learn: {early}", file=sys.stderr)
    return learn(listener.samples, Schedule, robots, lambda: notes)


def _statuses(daemon: Client, robot: str | None) -> list[Status]:
    """Return what daemons say of themselves; nothing where there is none, as at a router. Raises NoAnswerError."""
    try:
        return daemon.status(robot)
    except NoAnswerError:
        if robot is not None:
            raise
        return []


def _check(text: str) -> None:
    """Load what was learned as the daemon would. Raises OutputError when it cannot."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "learned.toml")
        file.write_text(text, encoding="utf-8")
        try:
            load_specs(file)
        except SpecsError as error:
            raise OutputError(
                f"what was learned is no right spec, which is a mistake of Sendworthy:\n{error}"
            ) from None


def _check_free(path: Path, *, force: bool, replaced: bool) -> None:
    """Raise OutputError where a file stands in the way, or none could be written; one that is `replaced` is anew."""
    try:
        if path.exists() and not force:
            raise OutputError(f"{path} exists; --force replaces it")
        anew = replaced and (path.is_file() or not path.exists())
        check_writable([_beside(Path(os.path.realpath(path))) if anew else path], folders=replaced)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror}") from None


@contextmanager
def _recording(path: Path, robots: Sequence[str]) -> Iterator[Writer]:
    """Write to a file from now on. Raises OutputError where that cannot be done, or could not be in here."""
    try:
        with path.open("wb", buffering=0) as file:  # whatever ends it, what was heard is there
            yield Writer(file, robots)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror}") from None


def _write(text: str, path: Path) -> None:
    """Put the file in place whole, and say whether it goes with its neighbours. Raises OutputError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if is_no_file(path):  # a pipe or a device: it has no neighbours
            path.write_text(text, encoding="utf-8")
            return
        _replace(Path(os.path.realpath(path)), text)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror}") from None
    print(f"{path}: written; now set the weights and the limit in it")
    try:
        load_specs(path.parent)
    except SpecsError as error:
        print(f"sendworthy learn: with the other files of {path.parent}, it is not right:\n{error}", file=sys.stderr)


def _beside(path: Path) -> Path:
    """Return the file that is written whole before it takes another one's place."""
    return path.with_name(f".{path.name}.new")


def _replace(path: Path, text: str) -> None:
    """Write a file that is there whole or not at all. Raises OSError."""
    beside = _beside(path)
    try:
        beside.write_text(text, encoding="utf-8")
        beside.replace(path)
    except OSError:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        raise
