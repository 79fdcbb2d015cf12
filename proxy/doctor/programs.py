"""Programs of the administrator that know more of this host."""

import os
import shutil
import subprocess

_PLACES = "/usr/sbin:/sbin"
_WAIT = 5.0
"""None of those that are asked takes this long [s]."""


def asked(*command: str) -> str | None:
    """Return what a program says, its complaints too; None when it is not installed or says nothing in time."""
    path = f"{os.environ.get('PATH', os.defpath)}:{_PLACES}"
    program = shutil.which(command[0], path=path)
    if program is None:
        return None
    try:
        done = subprocess.run([program, *command[1:]], check=False, capture_output=True, text=True, timeout=_WAIT)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout + done.stderr
