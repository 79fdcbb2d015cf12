"""The log of the daemon: one line per event on standard error, to read or for programs."""

import datetime as dt
import json
import logging
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock
from typing import TextIO

from proxy import clock
from proxy.config import LogConfig
from proxy.printable import clean

PLAIN = "%(levelname)s %(name)s: %(message)s"
STAMPED = f"%(asctime)s {PLAIN}"

AT_ONCE = 10
"""So many warnings and errors for one reason are logged, and as many every `PERIOD`."""
NEWS_AT_ONCE = 100
"""The same of what is no warning: all robots of a team may come at once."""
PERIOD = 60.0
"""How long it takes until as many are logged again [s]."""
REASONS = 256
"""Reasons that are told apart; when there are more, the one that began first is forgotten."""

PRIORITIES = {"CRITICAL": 2, "ERROR": 3, "WARNING": 4, "INFO": 6, "DEBUG": 7}
"""Those of syslog, by level. Source: sd-daemon(3)."""

_USUAL = frozenset(vars(logging.makeLogRecord({}))) | {"message", "asctime", "taskName"}
"""What every record has; anything else is a field that was given with `extra`."""


class OneLine(logging.Formatter):
    """Formats a record, traceback included, as a single line."""

    def format(self, record: logging.LogRecord) -> str:
        """Format `record`; what would start a new line is joined by a bar, what a terminal would obey replaced."""
        text = " | ".join(line.strip() for line in super().format(record).splitlines() if line.strip())
        left_out = fields(record).get("left_out")
        return clean(f"{text} ({left_out} more like it were left out)" if left_out else text)


class JsonLine(logging.Formatter):
    """Formats a record as an object of JSON on a single line."""

    def format(self, record: logging.LogRecord) -> str:
        """Format `record`, with the fields that were given as `extra`, and its traceback."""
        at = dt.datetime.fromtimestamp(record.created, dt.UTC)
        line: dict[str, object] = {
            "ts": at.isoformat(timespec="milliseconds").replace("+00:00", "Z"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **fields(record),
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, default=str)


class Prioritised(logging.Formatter):
    """Puts the priority before what another formatter writes: the journal takes it from there."""

    def __init__(self, formatter: logging.Formatter) -> None:
        super().__init__()
        self._formatter = formatter

    def format(self, record: logging.LogRecord) -> str:
        """Format `record`."""
        return f"<{PRIORITIES.get(record.levelname, 6)}>{self._formatter.format(record)}"


@dataclass(slots=True)
class _Spell:
    """What was logged for one reason `since` then [s], and what of it was left out."""

    since: float
    logged: int = 0
    left_out: int = 0


class NotTooOften(logging.Filter):
    """Lets few lines for one reason through; the first one after `PERIOD` tells how many were left out.

    A stranger that came and went under new names had 32 lines a second logged on each robot. The reason is the field
    `reason`, or the message before its arguments are put in. From any thread.
    """

    def __init__(self) -> None:
        super().__init__()
        self._lock = Lock()
        self._spells: dict[tuple[str, int], _Spell] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether `record` is logged."""
        if record.levelno < logging.INFO:
            return True
        most = AT_ONCE if record.levelno >= logging.WARNING else NEWS_AT_ONCE
        now, reason = clock.monotonic(), (_reason(record), most)
        with self._lock:
            spell = self._spells.get(reason)
            if spell is None or now >= spell.since + PERIOD:
                if spell is not None and spell.left_out:
                    record.left_out = spell.left_out
                spell = self._begin(now, reason)
            spell.logged += 1
            spell.left_out += spell.logged > most
            return spell.logged <= most

    def _begin(self, now: float, reason: tuple[str, int]) -> _Spell:
        if len(self._spells) >= REASONS:
            del self._spells[next(iter(self._spells))]
        self._spells.pop(reason, None)
        self._spells[reason] = spell = _Spell(now)
        return spell


def set_up_logging(config: LogConfig, environ: Mapping[str, str], stream: TextIO | None = None) -> None:
    """Log to `stream` (standard error) as `config` says. Under systemd the journal stamps the lines."""
    to = stream or sys.stderr
    journal = to_journal(environ, to)
    text = OneLine(PLAIN if journal else STAMPED)
    formatter = JsonLine() if config.format == "json" else text
    handler = logging.StreamHandler(to)
    handler.setFormatter(Prioritised(formatter) if journal else formatter)
    handler.addFilter(NotTooOften())
    logging.basicConfig(level=config.level.upper(), handlers=[handler], force=True)


def to_journal(environ: Mapping[str, str], stream: TextIO) -> bool:
    """Whether what is written to `stream` goes to the journal of systemd.

    `JOURNAL_STREAM` names the device and inode of what the service was started with, which programs that it starts
    inherit though they may write elsewhere. Source: systemd.exec(5).
    """
    try:
        found = os.fstat(stream.fileno())
    except (OSError, ValueError):
        return False
    return environ.get("JOURNAL_STREAM") == f"{found.st_dev}:{found.st_ino}"


def fields(record: logging.LogRecord) -> dict[str, object]:
    """Return what was given with a record beside its message."""
    return {name: value for name, value in vars(record).items() if name not in _USUAL}


def _reason(record: logging.LogRecord) -> str:
    """Return what `record` is about; a text that is put in whole is all that tells what that is."""
    given = fields(record).get("reason")
    template = str(record.msg)
    return str(given) if given else record.getMessage() if template == "%s" else template
