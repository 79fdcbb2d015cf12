"""Flies the surveillance mission of the paper (§4.3) and writes `studies/results/surveillance.md` and its pictures.

What was flown is kept in `build/surveillance`; called again it goes on from there. All takes 22 minutes
on an idle machine; `--most` limits one call. The delays under a tenth of a core need root, and are left out without.
"""

import argparse
import sys
from datetime import UTC, datetime
from pathlib import Path

from studies.surveillance.delays import measure
from studies.surveillance.flying import MISSIONS, fly, kept
from studies.surveillance.report import write_report

STORE = Path("build/surveillance")
PAGE = Path("studies/results/surveillance.md")
DELAYS = 80.0
"""How long each way is measured [s]."""


def main(arguments: list[str] | None = None) -> int:
    """Fly what is missing, then write the page of what is there; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m studies.surveillance", description=__doc__)
    parser.add_argument("--most", type=float, default=3600.0, metavar="S", help="begin no run after this time")
    parser.add_argument("--store", type=Path, default=STORE, help=f"where runs are kept (default: {STORE})")
    parser.add_argument("--page", type=Path, default=PAGE, help=f"what is written (default: {PAGE})")
    parser.add_argument("--only", choices=("missions", "delays", "page"), help="this part alone")
    options = parser.parse_args(arguments)
    store = options.store.resolve()
    if options.only in (None, "missions"):
        fly(store, MISSIONS, options.most, lambda what: print(what, flush=True))
    if options.only in (None, "delays"):
        for delay in measure(store, DELAYS, options.most):
            print(f"{delay.way}: {1e3 * delay.sent[0]:.1f} ms, 99 % {1e3 * delay.sent[1]:.1f} ms", flush=True)
    if options.only in (None, "page"):
        write_report(options.page, list(kept(store, MISSIONS)), measure(store, 0.0, -1.0), datetime.now(UTC))
    return 0


if __name__ == "__main__":
    sys.exit(main())
