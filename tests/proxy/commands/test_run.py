"""`sendworthy run`: start, stop and refuse."""

import gc
import json
import signal
import socket
import threading
from pathlib import Path
from queue import SimpleQueue

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.commands.client import connected
from proxy.commands.run import settle, started
from proxy.config import AppConfig, BridgeConfig, Config, MeshConfig
from tests.daemons import specs_file
from tests.ports import free_port
from utility_specs import Specs

THREADS = 30
"""A daemon without links has no more than so many."""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_stops_the_daemon_cleanly(start, number):
    """The exit code is 0 and the log says why it stopped."""
    daemon = start("--robot", "r1")
    daemon.wait_for("sendworthy ")
    assert daemon.end(number) == exit_codes.OK
    assert any(f"stopping on {number.name}" in line for line in daemon.lines)


BUSY = """
import sys
from planner import SearchSettings, start
from proxy.cli import main
from proxy.loop import Loop
from tests.planner.windows import window

run, problem = Loop._run, window(1)

def busy(self):
    run(self)
    while True:
        start(problem, SearchSettings(engine="native"), 1).run(100)

Loop._run = busy
sys.exit(main())
"""


@pytest.mark.full
def test_a_busy_daemon_ends_cleanly(start):
    """Its loop, that still searches when it stops, aborts nothing, and nothing is said of what it has in hand."""
    daemon = start("--robot", "r1", program=("-c", BUSY))
    daemon.wait_for("sendworthy ")
    assert daemon.end() == exit_codes.OK
    assert not [line for line in daemon.lines if "leaked" in line]


def test_the_start_is_one_line_with_everything(start, tmp_path):
    """The log says who runs where, in which mode, with which specs; threads are few, Zenoh's are given by number."""
    specs = specs_file(tmp_path)
    daemon = start("--robot", "r7", "--mode", "shadow", "--specs.path", str(specs))
    line = daemon.wait_for("sendworthy ")
    assert f"robot r7, mode shadow, apps on {daemon.endpoint}, mesh on nothing, specs " in line
    assert line.endswith(f" (1 information type from {specs})\n")
    threads = Path(f"/proc/{daemon.process.pid}/task").iterdir()
    assert len(list(threads)) <= THREADS


def test_a_limit_that_holds_little_beside_digests_is_logged_at_the_start(start, tmp_path):
    """As other warnings are."""
    specs = specs_file(tmp_path)
    specs.write_text(specs.read_text().replace("2 Mbit/s", "5 kbit/s"))
    daemon = start("--robot", "r1", "--specs.path", str(specs))
    line = daemon.wait_for("64 % of it is for what the daemons of 4 robots tell each other")
    assert f'WARNING proxy.reloading: {specs}: constraint "throughput": ' in line


def test_without_specs_everything_passes():
    """The line at the start says that nothing is filtered, and how others are found."""
    line = started(Config(robot="r1"), Specs.empty(), "r1-ab12")
    assert line.endswith(
        "robot r1-ab12, mode enforce, apps on tcp/127.0.0.1:7447 tcp/[::1]:7447, "
        "mesh on tcp/0.0.0.0:7500 with scouting, no specs in specs.d: everything passes"
    )


@pytest.mark.parametrize("there", [False, pytest.param(True, marks=pytest.mark.full)], ids=["missing", "empty"])
def test_a_folder_without_specs_makes_a_plain_bridge_that_specs_can_be_pushed_to(start, tmp_path, capsys, there):
    """It starts with one line that says so, status repeats it, and what is pushed is in force at once."""
    folder, elsewhere = tmp_path / "robot" / "specs.d", tmp_path / "ours"
    elsewhere.mkdir()
    if there:
        folder.mkdir(parents=True)
    daemon = start("--robot", "r1", "--specs.path", str(folder), "--fleet.specs", "true")
    line = daemon.wait_for("sendworthy ")
    assert line.endswith(f"no specs in {folder}: everything passes\n")
    assert daemon.lines == [line]
    assert main(["status", "--connect", daemon.endpoint]) == exit_codes.OK
    assert f"no specs in {folder}: everything passes" in capsys.readouterr().out
    assert main(["push", str(specs_file(elsewhere)), "--connect", daemon.endpoint]) == exit_codes.OK
    pushed = capsys.readouterr().out
    daemon.wait_for(pushed.removeprefix("r1: "))
    assert (folder / "camera.toml").exists()


def test_rules_of_the_bridge_are_told_at_the_start():
    """Who reads that everything passes reads also what keeps it from it."""
    bridge = BridgeConfig(profile="ros2")
    line = started(Config(robot="r1", bridge=bridge), Specs.empty(), "r1")
    assert line.endswith("no specs in specs.d: everything passes, rules of [bridge], profile ros2")


def test_routers_that_are_joined_are_said_at_the_start():
    """The line names those of the apps and those at which robots meet; there is no scouting then."""
    config = Config(
        robot="r1",
        app=AppConfig(listen=(), connect=("tcp/127.0.0.1:7447",), scouting=True),
        mesh=MeshConfig(mode="client", connect=("tcp/10.0.0.9:7447",)),
    )
    assert started(config, Specs.empty(), "r1").endswith(
        "apps on the router tcp/127.0.0.1:7447 with scouting, mesh on the router tcp/10.0.0.9:7447, "
        "no specs in specs.d: everything passes"
    )


def test_the_environment_configures_the_daemon(start, capsys):
    """A variable does what a key of the file does."""
    daemon = start(SENDWORTHY_ROBOT="r9", SENDWORTHY_MODE="pass")
    daemon.wait_for("sendworthy ")
    assert main(["status", "--json", "--connect", daemon.endpoint]) == exit_codes.OK
    status = json.loads(capsys.readouterr().out)
    assert (status["robot"], status["mode"]) == ("r9", "pass")


def test_bad_specs_keep_the_daemon_from_starting(start, tmp_path):
    """The exit code is 78, and each mistake has its file, line and key."""
    specs = specs_file(tmp_path)
    specs.write_text(specs.read_text().replace('"video"', '"vidoe"').replace("2 Mbit/s", "2 Mbot/s"))
    daemon = start("--robot", "r1", "--specs.path", str(specs))
    assert daemon.process.wait(60) == exit_codes.CONFIG
    daemon.end()
    assert [line.split(": ")[0] for line in daemon.lines] == [f"{specs}:3", f"{specs}:10"]


def test_a_missing_configuration_is_a_bad_one(start, tmp_path):
    """Who asks for a file means it."""
    daemon = start("--config", str(tmp_path / "gone.toml"))
    assert daemon.process.wait(60) == exit_codes.CONFIG
    daemon.end()
    assert daemon.lines == [f"{tmp_path}/gone.toml: does not exist\n"]


@pytest.mark.full
def test_a_port_in_use_is_one_clear_line(start):
    """The second daemon on a robot gives up and says which port is taken."""
    first = start("--robot", "r1")
    first.wait_for("sendworthy ")
    second = start("--robot", "r2", endpoint=first.endpoint)
    assert second.process.wait(60) == exit_codes.UNAVAILABLE
    second.end()
    (line,) = second.lines
    assert first.endpoint in line
    assert "port in use" in line


WITHOUT_MCAP = """
import sys
from proxy.cli import main

sys.modules["proxy.recording.output"] = None
sys.exit(main())
"""


def test_a_recording_that_needs_what_is_not_installed_is_a_wrong_configuration(start):
    """Started anew it would fail for ever, which systemd sees by the exit code; the message names the key."""
    daemon = start("--robot", "r1", "--record.on", "true", program=("-c", WITHOUT_MCAP))
    assert daemon.process.wait(60) == exit_codes.CONFIG
    daemon.end()
    assert 'record.on: recording needs the extra "record": pip install' in daemon.lines[-1]


EARLY = """
import sys
from pathlib import Path
from proxy.cli import main
from proxy.opening import Opening

made, specs = Opening.__init__, Path(sys.argv.pop())

def open_late(self, config):
    specs.write_text(specs.read_text().replace("1.0", "2.0"))
    made(self, config)

Opening.__init__ = open_late
sys.exit(main())
"""


def test_specs_that_change_while_it_starts_are_put_in_force(start, tmp_path):
    """A script may start the service, and copy them then."""
    path = specs_file(tmp_path)
    daemon = start("--robot", "r1", "--specs.path", str(path), str(path), program=("-c", EARLY))
    daemon.wait_for("files changed: specs ")


def test_an_unreachable_peer_does_not_hinder_the_start(start):
    """Robots come and go; the daemon serves its own applications meanwhile."""
    daemon = start("--robot", "r1", "--mesh.connect", '["tcp/127.0.0.1:1"]')
    daemon.wait_for("sendworthy ")
    assert main(["mode", "pass", "--connect", daemon.endpoint]) == exit_codes.OK


def test_a_radio_that_is_none_is_one_clear_line(start):
    """Broadcast needs the interface of the radio; the line names the key."""
    daemon = start("--mesh.transport", "broadcast", "--mesh.interface", "nope0")
    assert daemon.process.wait(60) == exit_codes.UNAVAILABLE
    daemon.end()
    (line,) = daemon.lines
    assert "mesh.interface nope0, mesh.group 224.0.0.226:7449: cannot broadcast: Interface nope0 not found" in line


def test_the_start_says_where_samples_are_broadcast(start):
    """Group and interface stand beside the endpoints of the mesh."""
    group = f"224.0.0.226:{free_port()}"
    daemon = start("--mesh.transport", "broadcast", "--mesh.interface", "lo", "--mesh.group", group)
    assert f", broadcast on {group} (lo), " in daemon.wait_for("sendworthy ")


def test_changed_specs_are_put_in_force(start, tmp_path):
    """The file alone is enough; one that is wrong changes nothing, is told with file, line and key, and mended."""
    specs = specs_file(tmp_path)
    daemon = start("--robot", "r1", "--specs.path", str(specs))
    daemon.wait_for("sendworthy ")
    good = specs.read_text()
    with daemon.paused():
        specs.write_text(good.replace("weight = 1.0", "weight = 2.0"))
    generation = daemon.wait_for("files changed: specs ").split("specs ")[1].split()[0]
    with daemon.paused():
        specs.write_text(good.replace('"video"', '"vidoe"'))
    assert f'{specs}:10: information_type "camera": utility.kind: ' in daemon.wait_for("nothing is reloaded")
    status = daemon.status()
    assert status["specs"] == generation
    assert status["daemon"]["reloads"]["problems"][0].startswith(f"{specs}:10: ")
    assert any("the files that changed are not in force" in warning for warning in status["warnings"])
    with daemon.paused():
        specs.write_text(good)
    daemon.wait_for("files changed: specs ")
    assert daemon.status()["daemon"]["reloads"] == {"done": 2, "refused": 1, "problems": []}


def test_sighup_has_everything_read_again(start, tmp_path):
    """Specs, and what of the configuration may change; all else is refused by name."""
    specs_file(tmp_path)
    config = tmp_path / "sendworthy.toml"
    config.write_text('robot = "r1"\n[specs]\npath = "camera.toml"\n')
    daemon = start("--config", str(config))
    daemon.wait_for("sendworthy ")
    with daemon.paused():
        config.write_text('robot = "r1"\nmode = "shadow"\n[specs]\npath = "camera.toml"\n[log]\nlevel = "debug"\n')
        daemon.process.send_signal(signal.SIGHUP)
    assert ", mode shadow, log.level debug" in daemon.wait_for("SIGHUP: specs ")
    assert daemon.status()["mode"] == "shadow"
    assert [line.split("INFO ")[-1][:15] for line in daemon.lines[1:]] == ["proxy.reloading"], "a line for a reload"
    with daemon.paused():
        config.write_text('robot = "r2"\n[specs]\npath = "camera.toml"\n')
        daemon.process.send_signal(signal.SIGHUP)
    assert f'{config}:1: robot: cannot change while the daemon runs: "r1" is in force, not "r2"' in daemon.wait_for(
        "nothing is reloaded"
    )
    assert daemon.status()["mode"] == "shadow"


def test_files_of_conf_d_count_at_the_start_and_while_it_runs(start, tmp_path):
    """They win over the main file; one that comes later is in force at once, and a wrong one changes nothing."""
    config, further = tmp_path / "sendworthy.toml", tmp_path / "conf.d"
    further.mkdir()
    config.write_text('robot = "r1"\nmode = "pass"\n')
    (further / "10-name.toml").write_text('robot = "r2"\n')
    daemon = start("--config", str(config))
    assert "robot r2, mode pass" in daemon.wait_for("sendworthy ")
    with daemon.paused():
        (further / "20-mode.toml").write_text('mode = "shadow"\n')
    assert ", mode shadow" in daemon.wait_for("files changed: ")
    assert daemon.status()["mode"] == "shadow"
    with daemon.paused():
        (further / "30-bad.toml").write_text('\n[mesh.zenoh]\nmod = "peer"\n')
    assert f"{further}/30-bad.toml:3: mesh.zenoh.mod: unknown key of Zenoh" in daemon.wait_for("nothing is reloaded")
    assert daemon.status()["mode"] == "shadow"


def test_systemd_hears_what_it_waits_for(start, tmp_path):
    """Ready when samples can come, alive again and again, reloading and ready again, stopping."""
    specs = specs_file(tmp_path)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(str(tmp_path / "notify"))
        heard = SimpleQueue()

        def hear():
            """At once, as systemd does: the kernel keeps ten messages, and the daemon waits for nobody."""
            message = ""
            while message != "STOPPING=1":
                message = systemd.recv(4096).decode()
                heard.put(message)

        threading.Thread(target=hear, daemon=True).start()

        def told(what):
            while not (message := heard.get(timeout=60.0)).startswith(what):
                assert message == "WATCHDOG=1"
            return message

        daemon = start(
            *("--robot", "r1", "--specs.path", str(specs)),
            NOTIFY_SOCKET=systemd.getsockname(),
            WATCHDOG_USEC="300000",
        )
        assert "robot r1, mode enforce" in told("READY=1\nSTATUS=sendworthy ")
        assert told("WATCHDOG=1")
        specs.write_text(specs.read_text().replace("weight = 1.0", "weight = 2.0"))
        daemon.process.send_signal(signal.SIGHUP)
        assert "MONOTONIC_USEC=" in told("RELOADING=1")
        ready = told("READY=1")
        assert daemon.status()["specs"] in ready
        assert main(["mode", "shadow", "--connect", daemon.endpoint]) == exit_codes.OK
        daemon.process.send_signal(signal.SIGHUP)
        assert told("RELOADING=1")
        assert "robot r1, mode shadow" in told("READY=1"), "the mode in force, which is not that of the file"
        daemon.process.send_signal(signal.SIGTERM)
        assert told("STOPPING=1")


def test_the_text_of_specs_is_told_as_it_stands_in_their_files(start, tmp_path):
    """Whoever edits it elsewhere, as with the page, takes away no comment that came meanwhile."""
    specs = specs_file(tmp_path)
    daemon = start("--robot", "r1", "--specs.path", str(specs))
    daemon.wait_for("sendworthy ")
    with connected(daemon.endpoint) as client:
        before = client.specs("r1")
        specs.write_text(f"# As agreed.\n{specs.read_text()}")
        daemon.wait_for("files changed")
        assert client.specs("r1") == (before[0], {specs.name: specs.read_text()})


def test_what_is_there_at_the_start_is_never_looked_through_again():
    """A full collection of all modules would stop every thread, whatever the deadline of a decision is."""
    try:
        settle()
        assert len(gc.get_objects()) < gc.get_freeze_count()
    finally:
        gc.unfreeze()
