"""The model of the configuration: its defaults and its list of settings."""

import pytest
from pydantic import ValidationError

from proxy.config import Config, MeshConfig, settings
from proxy.core.model.mode import Mode


def test_defaults_are_those_of_the_manual():
    """A robot without any configuration filters between localhost and a scouted mesh."""
    config = Config(robot="r1")
    assert config.model_dump(mode="json", by_alias=True) == {
        "robot": "r1",
        "mode": "enforce",
        "app": {
            "connect": [],
            "listen": ["tcp/127.0.0.1:7447", "tcp/[::1]:7447"],
            "scouting": False,
            "zenoh": {},
        },
        "mesh": {
            "mode": "peer",
            "listen": ["tcp/0.0.0.0:7500"],
            "connect": [],
            "scouting": True,
            "interface": "auto",
            "transport": "unicast",
            "group": "224.0.0.226:7449",
            "allowance": 0.02,
            "zenoh": {},
        },
        "bridge": {
            "profile": "none",
            "out": {"allow": ["**"], "deny": [], "bypass": []},
            "in": {"allow": ["**"], "deny": []},
        },
        "specs": {"path": "specs.d"},
        "fleet": {"specs": False, "mode": False, "token": "", "token_file": ""},
        "planner": {
            "iterations": 300,
            "deadline": 0.02,
            "horizon": 120,
            "backlog": 32,
            "search": "best",
            "engine": "native",
            "coordination": "announce",
        },
        "queue": {"samples": 4096, "bytes": 32 * 1024 * 1024},
        "clock": {"error": 0.0},
        "log": {"level": "info", "format": "text"},
        "record": {
            "on": False,
            "folder": "recordings",
            "file_bytes": 64 * 1024 * 1024,
            "disk_bytes": 1024 * 1024 * 1024,
            "payloads": False,
        },
        "metrics": {"listen": ""},
    }


def test_there_is_room_for_two_recordings():
    """One is written while the last one is still there."""
    with pytest.raises(ValidationError, match="disk_bytes must be at least twice file_bytes, 134217728"):
        Config.model_validate({"record": {"disk_bytes": 100_000_000}})


def test_a_token_stands_in_one_place():
    """Which of two would count nobody could guess; a short one is refused where it stands."""
    with pytest.raises(ValidationError, match="token and token_file exclude each other"):
        Config.model_validate({"fleet": {"token": "a token of this team", "token_file": "token"}})
    with pytest.raises(ValidationError, match="a token has 16 to 4096 printable letters"):
        Config.model_validate({"fleet": {"token": "short"}})


def test_config_is_frozen():
    """Nobody changes the configuration of a running daemon behind its back."""
    with pytest.raises(ValidationError):
        Config().mode = Mode.PASS


def test_settings_name_every_key_with_a_description():
    """Every key of the model is a setting, so it has a flag, a variable and a help text."""
    found = {setting.key: setting for setting in settings()}
    dumped = Config().model_dump(mode="json", by_alias=True)

    def keys(tree, path=()):
        """The paths of everything but tables; `zenoh` is a setting itself."""
        for name, value in tree.items():
            if isinstance(value, dict) and name != "zenoh":
                yield from keys(value, (*path, name))
            else:
                yield ".".join((*path, name))

    assert list(found) == list(keys(dumped))
    assert all(setting.description for setting in found.values())


def test_settings_tell_the_words_that_there_are():
    """So that a shell can complete them."""
    found = {setting.key: setting for setting in settings()}
    assert found["mode"].values == ("pass", "shadow", "enforce")
    assert found["log.format"].values == ("text", "json")
    assert found["mesh.scouting"].values == ("true", "false")
    assert found["planner.iterations"].values == ()


def test_settings_tell_what_a_flag_may_hold():
    """Text needs no quotes, tables may be gone into, everything else is TOML."""
    found = {setting.key: setting for setting in settings()}
    text = {key for key, setting in found.items() if setting.takes_text}
    assert text == {
        "robot",
        "mode",
        "mesh.mode",
        "mesh.interface",
        "mesh.transport",
        "mesh.group",
        "bridge.profile",
        "specs.path",
        "fleet.token",
        "fleet.token_file",
        "planner.search",
        "planner.engine",
        "planner.coordination",
        "log.level",
        "record.folder",
        "log.format",
        "metrics.listen",
    }
    assert {key for key, setting in found.items() if setting.takes_table} == {"app.zenoh", "mesh.zenoh"}


@pytest.mark.parametrize(
    ("mesh", "secured"),
    [
        ({}, False),
        ({"listen": ("tls/0.0.0.0:7500",)}, True),
        ({"connect": ("quic/10.0.0.2:7500",)}, True),
        ({"connect": ("tcp/10.0.0.2:7500",)}, False),
    ],
)
def test_tls_on_the_mesh_is_known_by_its_endpoints(mesh, secured):
    """Where robots know who speaks, nobody is believed on the air."""
    assert MeshConfig(**mesh).secured is secured
