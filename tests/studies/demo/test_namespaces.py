"""The medium as the kernel makes it: what can be said without root. `tests/system/test_demo.py` uses it."""

import os

import pytest

from studies.demo.air import Air
from studies.demo.namespaces import Namespaces
from studies.demo.processes import DemoError


def test_it_needs_root(monkeypatch):
    """And says so."""
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(DemoError, match="--netns: network namespaces need root"):
        Namespaces(Air(1e6))


def test_it_names_the_program_that_is_missing(monkeypatch):
    """And where it comes from."""
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr("studies.demo.namespaces._TOOLS", "/nowhere")
    with pytest.raises(DemoError, match=r"--netns: needs the program ip \(Debian: iproute2\)"):
        Namespaces(Air(1e6))
