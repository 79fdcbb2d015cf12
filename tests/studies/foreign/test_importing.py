"""`sendworthy import`."""

import os
import sys
from pathlib import Path

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.recording.entries import End, Payload, Start, Traffic
from proxy.recording.reading import RecordingReader
from studies.foreign import importing
from tests.studies.foreign.rosbags_written import write_bag

SPEC = """
[[information_type]]
name = "battery"
keys = ["*/r1/battery/**"]
utility = { kind = "video" }
features.charge = { kind = "cdr", type = "sensor_msgs/msg/BatteryState", field = "percentage", default = 1.0 }
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("t.csv").write_text("t_gen,robot,key,size\n1,r1,a,5\n")
    return tmp_path


def entries(name):
    reader = RecordingReader(Path(name))
    found = list(reader)
    assert not reader.problems
    return found


def test_a_bag_keeps_its_payloads(place):
    """So that any specs can be tried; each payload stands before its sample."""
    write_bag(place / "bag")
    assert main(["import", "bag", "-o", "bag.mcap", "--robot", "rover"]) == exit_codes.OK
    start, *told, end = entries("bag.mcap")
    assert isinstance(start, Start)
    assert (start.kind, start.source, start.payloads) == ("traffic", "bag", True)
    assert isinstance(end, End)
    payloads, traffic = told[::2], told[1::2]
    assert len(traffic) == 90
    for payload, sample in zip(payloads, traffic, strict=True):
        assert isinstance(payload, Payload)
        assert isinstance(sample, Traffic)
        assert sample.robot == "rover"
        assert (payload.key, len(payload.data)) == (sample.key, sample.size)


def test_with_specs_it_keeps_the_features_that_they_know(place):
    """Without payloads it is small."""
    write_bag(place / "bag")
    Path("spec.toml").write_text(SPEC)
    assert main(["import", "bag", "-o", "bag.mcap", "--specs", "spec.toml"]) == exit_codes.OK
    _, *traffic, _ = entries("bag.mcap")
    assert all(isinstance(each, Traffic) for each in traffic)
    charges = [each.features["charge"] for each in traffic if "battery" in each.key]
    assert charges == pytest.approx([1.0 - i / 100 for i in range(30)])
    assert {bool(each.features) for each in traffic if "battery" not in each.key} == {False}


def test_several_files_are_one_recording(place, capsys):
    """In the order of their times, whatever each is."""
    write_bag(place / "bag1")
    write_bag(place / "bag2", "sqlite3")
    assert main(["import", "bag1", "bag2", "t.csv", "-o", "all.mcap"]) == exit_codes.OK
    assert "181 samples of bag1 (90), bag2 (90), r1 (1) on 4 keys" in capsys.readouterr().out
    times = [each.t_gen for each in entries("all.mcap") if isinstance(each, Traffic)]
    assert times == sorted(times)


def test_bags_of_one_name_are_told_to_be_one_robot(place, capsys):
    """Folders of robots often hold bags that are all named alike; by namespace they are whose the topics say."""
    write_bag(place / "r1" / "bag")
    write_bag(place / "r2" / "bag")
    assert main(["import", "r1/bag", "r2/bag", "-o", "all.mcap"]) == exit_codes.OK
    assert "2 bags are taken for those of one robot, as they are named bag" in capsys.readouterr().err
    assert main(["import", "r1/bag", "r2/bag", "-o", "each.mcap", "--by-namespace"]) == exit_codes.OK
    assert "taken for" not in capsys.readouterr().err


def test_the_words_of_a_file_cannot_command_the_terminal(place, capsys):
    """Robots, topics and columns have whatever names others gave them."""
    write_bag(place / "r\x1b[2J")
    Path("t.csv").write_text("t_gen,robot,key,size,\x1b[2J\n1,r1,\x1b[2J,5,x\n")
    assert main(["import", "r\x1b[2J", "t.csv", "-o", "all.mcap"]) == exit_codes.OK
    shown = capsys.readouterr()
    assert "r\ufffd[2J (90)" in shown.out
    assert 'the column "\ufffd[2J" is text' in shown.err
    assert "\x1b" not in shown.out + shown.err
    assert main(["import", "\x1b[2J.csv", "-o", "none.mcap"]) == exit_codes.FAILED
    assert "\ufffd[2J.csv: No such file" in capsys.readouterr().err


def test_what_is_named_twice_is_imported_once(place, capsys):
    """A table, a bag, or a bag and its file."""
    write_bag(place / "bag")
    files = ["t.csv", "bag", "bag/bag.mcap", "./t.csv", "bag/../bag"]
    assert main(["import", *files, "-o", "all.mcap", "--robot", "r2"]) == exit_codes.OK
    assert "91 samples of r2 (90), r1 (1) on " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["none.csv"], exit_codes.FAILED, "none.csv"),
        (["none"], exit_codes.FAILED, "none does not exist"),
        (["none.csv"], exit_codes.FAILED, "import: none.csv: No such file or directory"),
        (["bad.csv"], exit_codes.FAILED, 'bad.csv:2: column "size" (4): "x" is not a number'),
        (["t.csv", "--specs", "none.toml"], exit_codes.CONFIG, "none.toml"),
        (["t.csv", "-o", "there.mcap"], exit_codes.FAILED, "there.mcap exists; --force replaces it"),
        (["t.csv", "-o", "t.csv", "--force"], exit_codes.FAILED, "t.csv is what is to be imported"),
        (["a", "b", "--robot", "r1"], exit_codes.FAILED, "--robot names the robot of one bag"),
        (["a", "--robot", "r/1"], exit_codes.FAILED, '--robot must be one chunk of a key, without /: "r/1"'),
        (["a", "--robot", ""], exit_codes.FAILED, "--robot must not be empty"),
        (["t.csv", "-o", "no/where.mcap"], exit_codes.FAILED, "-o no/where.mcap: there is no folder no"),
    ],
)
def test_what_cannot_be_imported_is_told_and_leaves_nothing_behind(place, capsys, arguments, code, message):
    """No half recording, either."""
    Path("bad.csv").write_text("t_gen,robot,key,size\n1,r1,a,x\n")
    Path("there.mcap").write_text("mine")
    before = {each: each.read_bytes() for each in place.iterdir()}
    where = [] if "-o" in arguments else ["-o", "out.mcap"]
    assert main(["import", *arguments, *where]) == code
    assert message in capsys.readouterr().err
    assert {each: each.read_bytes() for each in place.iterdir()} == before


def test_a_disk_that_gets_full_leaves_nothing_behind(place, capsys, monkeypatch):
    """And what was there stays."""

    def full(*_):
        raise OSError(28, "No space left on device")

    Path("out.mcap").write_text("mine")
    monkeypatch.setattr(importing.RecordingWriter, "traffic", full)
    assert main(["import", "t.csv", "-o", "out.mcap", "--force"]) == exit_codes.FAILED
    assert "No space left on device" in capsys.readouterr().err
    assert Path("out.mcap").read_text() == "mine"
    assert {each.name for each in place.iterdir()} == {"t.csv", "out.mcap"}


def test_a_link_stays_one(place):
    """What it leads to is replaced."""
    kept = place / "kept" / "out.mcap"
    kept.parent.mkdir()
    kept.write_text("mine")
    Path("out.mcap").symlink_to(kept)
    assert main(["import", "t.csv", "-o", "out.mcap", "--force"]) == exit_codes.OK
    assert Path("out.mcap").is_symlink()
    assert len(entries(kept)) == 3
    assert [each.name for each in kept.parent.iterdir()] == ["out.mcap"]


def test_a_pipe_stays_one(place, capsys):
    """A recording needs a file: its end is written many times."""
    os.mkfifo(place / "pipe")
    assert main(["import", "t.csv", "-o", "pipe", "--force"]) == exit_codes.FAILED
    assert "pipe is no file that could be replaced" in capsys.readouterr().err
    assert Path("pipe").is_fifo()


@pytest.mark.usefixtures("place")
def test_without_an_extra_it_says_which_to_install(capsys, monkeypatch):
    """That for recordings, or that for bags."""
    monkeypatch.setattr("studies.foreign.command.there", lambda _: False)
    assert main(["import", "bag", "-o", "out.mcap"]) == exit_codes.FAILED
    assert 'bag needs the extra "ros2": pip install "sendworthy[ros2]"' in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "studies.foreign.importing", None)
    assert main(["import", "t.csv", "-o", "out.mcap"]) == exit_codes.FAILED
    assert 'pip install "sendworthy[record]"' in capsys.readouterr().err
