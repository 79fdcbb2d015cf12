"""`sendworthy study characteristic`."""

import json
import sys
from pathlib import Path

import cv2
import pytest

from proxy import exit_codes
from proxy.cli import main
from studies.bench.folder import MISSIONS
from tests.studies.replay.traffic import POSE, samples, spec


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with specs and the traffic of two robots, 30 s each."""
    monkeypatch.chdir(tmp_path)
    Path("spec.toml").write_text(spec() + POSE)
    told = [*samples(30), *samples(30, size=200, key="r2/pose"), *samples(30, size=50, key="r2/other")]
    lines = [f"{each.t},{each.robot},{each.key},{each.size},{each.features['red']},x" for each in told]
    Path("traffic.csv").write_text("\n".join(["t_gen,robot,key,size,red,note", *lines]) + "\n")
    assert main(["import", "traffic.csv", "-o", "traffic.mcap"]) == exit_codes.OK
    return tmp_path


def study(*arguments):
    return main(["study", "characteristic", *map(str, arguments)])


@pytest.mark.usefixtures("place")
def test_an_imported_mission_is_characterised(capsys):
    """In words, with a histogram."""
    assert study("traffic.mcap", "--specs", "spec.toml") == exit_codes.OK
    shown = capsys.readouterr().out
    assert "180 samples of 2 robots" in shown
    assert "0.9 to 1.0" in shown
    assert "The better half of messages has " in shown


@pytest.mark.usefixtures("place")
@pytest.mark.full
def test_a_mission_of_the_benchmark_is_characterised(capsys):
    """With what its file says: streams, worth and latency."""
    assert study(MISSIONS / "paper-few.jsonl") == exit_codes.OK
    shown = capsys.readouterr().out
    assert "629 samples of 10 robots in 60 s" in shown
    assert "a few messages have nearly all of the utility" in shown
    assert study(MISSIONS / "recorded-cameras.jsonl") == exit_codes.OK
    assert "1,000 samples of 4 robots in 25 s" in capsys.readouterr().out
    for wrong in (("traffic.mcap",), ("--latency", "1 s"), ("--specs", "spec.toml")):
        assert study(MISSIONS / "paper-few.jsonl", *wrong) == exit_codes.FAILED
        assert "a mission of the benchmark is characterised alone" in capsys.readouterr().err
    Path("wrong.jsonl").write_text("{}")
    assert study("wrong.jsonl") == exit_codes.FAILED
    assert "wrong.jsonl:1: format: " in capsys.readouterr().err


@pytest.mark.usefixtures("place")
def test_figures_are_written_as_json(capsys):
    """To standard output alone, or to a file; the same seed gives the same."""
    capsys.readouterr()
    assert study("traffic.mcap", "--specs", "spec.toml", "--json", "-") == exit_codes.OK
    found = json.loads(capsys.readouterr().out)
    assert sum(found["levels"].values()) == pytest.approx(1.0)
    assert sum(found["histogram"]) == pytest.approx(1.0)
    assert found["robots"] == ["r1", "r2"]
    assert study("traffic.mcap", "--specs", "spec.toml", "--json", "found.json") == exit_codes.OK
    assert json.loads(Path("found.json").read_text()) == found
    assert study("traffic.mcap", "--specs", "spec.toml", "--seed", 1, "--json", "other.json") == exit_codes.OK
    assert json.loads(Path("other.json").read_text())["received"] != found["received"]


@pytest.mark.full
@pytest.mark.usefixtures("place")
def test_a_picture_is_drawn():
    """Of the kind that its name says."""
    assert study("traffic.mcap", "--specs", "spec.toml", "--picture", "c.png") == exit_codes.OK
    assert cv2.imread("c.png").std() > 1.0
    assert study("traffic.mcap", "--specs", "spec.toml", "--picture", "c.svg") == exit_codes.OK
    assert "eCDF" in Path("c.svg").read_text()


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nowhere.mcap",), "nowhere.mcap cannot be read: No such file"),
        (("traffic.csv",), "traffic.csv"),
        (("traffic.mcap",), "name utility specs with --specs"),
        (
            ("traffic.mcap", "--specs", "spec.toml", "--picture", "c.gif"),
            "c.gif: a picture is a file of .png, .svg, .pdf",
        ),
        (("traffic.mcap", "--specs", "other.toml"), "the specs cover no key of this traffic; it has r1/camera"),
    ],
)
def test_what_is_wrong_is_said(capsys, arguments, said):
    """In one line, and nothing is printed."""
    Path("other.toml").write_text(spec().replace("*/camera", "*/lidar"))
    capsys.readouterr()
    assert study(*arguments) == exit_codes.FAILED
    shown = capsys.readouterr()
    assert shown.err.startswith("sendworthy study: ")
    assert said in shown.err
    assert not shown.out


@pytest.mark.usefixtures("place")
def test_wrong_specs_are_wrong_here_too(capsys):
    """With the line."""
    Path("wrong.toml").write_text("[[information_type]]\nname = 3\n")
    assert study("traffic.mcap", "--specs", "wrong.toml") == exit_codes.CONFIG
    assert "wrong.toml:" in capsys.readouterr().err


@pytest.mark.parametrize(("option", "value"), [("--latency", "soon"), ("--seed", "-1")])
def test_wrong_arguments_are_refused(capsys, option, value):
    """Before anything is read."""
    with pytest.raises(SystemExit):
        study("x.mcap", f"{option}={value}")
    assert value in capsys.readouterr().err


def test_without_its_extra_it_says_which_to_install(monkeypatch, capsys):
    """Recordings are read by the package mcap."""
    monkeypatch.setitem(sys.modules, "studies.study.recorded", None)
    assert study("x.mcap") == exit_codes.FAILED
    assert 'needs the extra "record": pip install "sendworthy[record]"' in capsys.readouterr().err


@pytest.mark.full
@pytest.mark.usefixtures("place")
@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_picture_that_finds_no_room_is_told(capsys, kind):
    """Of any kind; and one in a folder that is not there before anything is computed."""
    full = Path(f"full.{kind}")
    full.symlink_to("/dev/full")
    assert study("traffic.mcap", "--specs", "spec.toml", "--picture", full) == exit_codes.FAILED
    assert capsys.readouterr().err == "sendworthy study: No space left on device\n"
    assert study("traffic.mcap", "--specs", "spec.toml", "--picture", f"none/c.{kind}") == exit_codes.FAILED
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("", f"sendworthy study: none/c.{kind}: No such file or directory\n")
