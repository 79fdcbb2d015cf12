"""Runs side by side are given ports of their own."""

import socket
import subprocess
import sys

import pytest

from studies.demo.ports import free_ports

ASK = "from studies.demo.ports import free_ports; print(*free_ports(400)); input()"


def test_what_is_given_is_different():
    """Also in turns."""
    assert len({*free_ports(50), *free_ports(50)}) == 100


def test_where_somebody_listens_is_not_given():
    """Even when its turn has come again."""
    with socket.socket() as held:
        held.bind(("127.0.0.1", free_ports(1)[0]))
        taken = held.getsockname()[1]
        assert taken not in {*free_ports(300), *free_ports(300)}


def test_more_than_there_are_are_refused():
    """Rather than fewer given."""
    with pytest.raises(OSError, match="not enough free ports"):
        free_ports(501)


def test_processes_have_none_in_common():
    """While they live: neither listens yet."""
    asked = [subprocess.Popen([sys.executable, "-c", ASK], stdin=-1, stdout=-1, text=True) for _ in range(3)]
    given = [set(map(int, process.stdout.readline().split())) for process in asked]
    for process in asked:
        process.communicate("\n")
    assert [len(ports) for ports in given] == [400] * 3
    assert len(set.union(*given)) == 1200
