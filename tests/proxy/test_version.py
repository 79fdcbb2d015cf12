"""Which Sendworthy this is."""

import sys
from importlib import metadata

from proxy.version import version


def test_the_version_is_the_one_that_is_installed():
    """It is read off a name."""
    assert version() == metadata.version("sendworthy")


def test_where_no_folder_is_named_after_it_python_knows_the_version(monkeypatch, tmp_path):
    """Python finds packages in other places, too."""
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    monkeypatch.setattr(metadata, "version", {"sendworthy": "1.2"}.get)
    assert version() == "1.2"
