"""A daemon hashes without OpenSSL; who imports its parts otherwise has it."""

import os
import subprocess
import sys

import pytest

from proxy.no_openssl import BINDING

LOADED = """
import sys
from proxy import cli
try:
    cli.main(sys.argv[1:])
except SystemExit:
    pass
import hashlib, hmac
print(sys.modules.get("_hashlib") is not None, hashlib.blake2b(b"x", digest_size=4).hexdigest())
print(hmac.new(b"k", b"m", hashlib.sha256).hexdigest())
"""


def answer(*arguments):
    """Return what a process says that runs a command of ours."""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("COV")}  # it imports hashlib
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *arguments], env=environ, capture_output=True, text=True, check=True
    )
    return [line.split() for line in done.stdout.splitlines()[-2:]]


@pytest.mark.full
@pytest.mark.parametrize(("command", "bound"), [("run", "False"), ("config", "True")])
def test_only_the_daemon_does_without(command, bound):
    """Its hashes are the same."""
    (loaded, digest), (signed,) = answer(command, "--help")
    assert loaded == bound
    assert (digest, signed) == tuple(
        word for line in answer("--version") for word in line if word not in ("True", "False")
    )


def test_what_is_imported_already_stays():
    """Here the tests have imported it."""
    assert sys.modules[BINDING] is not None
