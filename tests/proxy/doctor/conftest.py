"""Programs of the administrator that say what a test wants."""

import os

import pytest


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Install a program before all others, a script of the shell."""
    folder = tmp_path / "programs"
    folder.mkdir()
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")

    def install(name, script):
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)

    return install
