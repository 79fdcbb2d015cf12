"""The exit codes of the command line."""

import os

from proxy import exit_codes


def test_exit_codes_are_those_of_sysexits():
    """systemd and shells know these numbers."""
    assert exit_codes.UNAVAILABLE == os.EX_UNAVAILABLE
    assert exit_codes.CONFIG == os.EX_CONFIG
