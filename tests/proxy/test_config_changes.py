"""What may change while a daemon runs."""

from pathlib import Path

from proxy.config import AppConfig, BridgeConfig, Config, LogConfig, MeshConfig, MetricsConfig, SpecsConfig
from proxy.config_changes import changes


def test_nothing_differs_from_itself():
    """Equal configurations have no changes."""
    assert not list(changes(Config(robot="r1"), Config(robot="r1")))


def test_every_difference_is_told_in_the_order_of_the_manual():
    """With its key as people write it, and both values as they stand in files."""
    before = Config(robot="r1", mesh=MeshConfig(listen=("tcp/0.0.0.0:7500",)))
    after = Config(
        robot="r2",
        mode="shadow",
        app=AppConfig(zenoh={"timestamping": {"enabled": True}}),
        mesh=MeshConfig(listen=("tcp/0.0.0.0:7501",)),
        bridge=BridgeConfig.model_validate({"in": {"deny": ("a/**",)}}),
        specs=SpecsConfig(path=Path("/etc/specs.d")),
        log=LogConfig(level="debug", format="json"),
        metrics=MetricsConfig(listen="127.0.0.1:9447"),
    )
    assert [(".".join(change.path), change.before, change.after, change.live) for change in changes(before, after)] == [
        ("robot", "r1", "r2", False),
        ("mode", "enforce", "shadow", True),
        ("app.zenoh", {}, {"timestamping": {"enabled": True}}, False),
        ("mesh.listen", ["tcp/0.0.0.0:7500"], ["tcp/0.0.0.0:7501"], False),
        ("bridge.in.deny", [], ["a/**"], False),
        ("specs.path", "specs.d", "/etc/specs.d", True),
        ("log.level", "info", "debug", True),
        ("log.format", "text", "json", False),
        ("metrics.listen", "", "127.0.0.1:9447", False),
    ]


def test_a_refusal_has_both_values():
    """And says what to do."""
    (change,) = changes(Config(robot="r1"), Config(robot="r2"))
    assert change.refusal == 'cannot change while the daemon runs: "r1" is in force, not "r2"; restart it'


def test_a_refusal_tells_no_secret():
    """It stands in the log, and in the status that everybody on the robot can read."""
    before, after = (
        Config(robot="r1", mesh=MeshConfig(zenoh={"transport": {"auth": {"usrpwd": {"user": "r1", "password": word}}}}))
        for word in ("old word", "new word")
    )
    (change,) = changes(before, after)
    assert '"user": "r1"' in change.refusal
    assert "word" not in change.refusal.replace("password", "")
