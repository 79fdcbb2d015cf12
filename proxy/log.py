"""The log of the daemon: one line per event on standard error."""

import logging
import sys
from collections.abc import Mapping
from typing import TextIO

PLAIN = "%(levelname)s %(name)s: %(message)s"
STAMPED = f"%(asctime)s {PLAIN}"


class OneLine(logging.Formatter):
    """Formats a record, traceback included, as a single line."""

    def format(self, record: logging.LogRecord) -> str:
        """Format `record`; what would start a new line is joined by a bar."""
        return " | ".join(line.strip() for line in super().format(record).splitlines() if line.strip())


def set_up_logging(level: str, environ: Mapping[str, str], stream: TextIO | None = None) -> None:
    """Log from `level` on to `stream` (standard error). Under systemd the journal stamps the lines."""
    handler = logging.StreamHandler(stream or sys.stderr)
    handler.setFormatter(OneLine(PLAIN if "JOURNAL_STREAM" in environ else STAMPED))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
