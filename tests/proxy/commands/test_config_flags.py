"""The flags of commands that read a configuration."""

import argparse

import pytest

from proxy.commands.config_flags import add_config_flags, further, reader


@pytest.fixture
def read():
    """Read the configuration of a command line."""

    def parsed(*words):
        parser = argparse.ArgumentParser()
        add_config_flags(parser, listed=False)
        arguments, unknown = parser.parse_known_args(words)
        assert not further(arguments, unknown)
        return reader(arguments)().config

    return parsed


def test_keys_are_flags_also_within_open_tables(read):
    """With a blank or an equals sign before the value."""
    config = read("--planner.iterations", "5", "--app.zenoh.scouting.delay=0", "--mesh.zenoh.mode", "peer")
    assert config.planner.iterations == 5
    assert config.app.zenoh == {"scouting": {"delay": 0}}
    assert config.mesh.zenoh == {"mode": "peer"}


def test_variables_come_under_flags(read, monkeypatch):
    """Both come over the file."""
    monkeypatch.setenv("SENDWORTHY_ROBOT", "variable")
    monkeypatch.setenv("SENDWORTHY_MODE", "shadow")
    config = read("--robot", "flag")
    assert (config.robot, config.mode) == ("flag", "shadow")


def test_what_is_no_key_is_left():
    """For the command line to refuse it."""
    arguments = argparse.Namespace(inside={})
    assert further(arguments, ["--app.zenoh.mode", "peer", "--other", "x"]) == ["--other", "x"]
    assert arguments.inside == {"app.zenoh.mode": "peer"}
