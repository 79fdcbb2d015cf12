"""`sendworthy bench`, as it is typed."""

import json
import sys
from pathlib import Path

import pytest

from proxy import exit_codes
from proxy.cli import main
from studies.bench.folder import names
from tests.studies.bench.small import lines, write
from tests.studies.replay.traffic import samples, spec


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with a mission and a policy."""
    monkeypatch.chdir(tmp_path)
    write(Path("small.jsonl"))
    Path("mine.py").write_text("class Never:\n    def decide(self, sample, situation):\n        return False\n")
    return tmp_path


def bench(*arguments):
    return main(["bench", *map(str, arguments)])


@pytest.mark.usefixtures("place")
def test_policies_are_flown_and_scored(capsys):
    """Ours and the one that was named, the best first; in several processes the same."""
    assert bench("--missions", "small.jsonl", "--policy", "mine.py:Never", "--json", "a.json") == exit_codes.OK
    shown = capsys.readouterr().out
    assert "small" in shown
    assert shown.index("greedy") < shown.index("mine.py:Never")
    chosen = ("--only", "--policy", "greedy", "--policy", "mine.py:Never", "--missions", "small.jsonl")
    assert bench(*chosen, "--jobs", 1, "--json", "-") == exit_codes.OK
    scores = json.loads(capsys.readouterr().out)["scores"]
    assert [score["policy"] for score in scores] == ["greedy", "mine.py:Never"]
    assert scores[1]["utility"] == scores[1]["sent"] == 0.0
    before = {score["policy"]: score["score"] for score in json.loads(Path("a.json").read_text())["scores"]}
    assert {score["policy"]: score["score"] for score in scores}.items() <= before.items()


@pytest.mark.usefixtures("place")
def test_a_leaderboard_is_written(capsys):
    """Beside the table."""
    chosen = ("--only", "--policy", "greedy", "--missions", "small.jsonl", "--jobs", 1)
    assert bench(*chosen, "--leaderboard", "pages/board.md") == exit_codes.OK
    assert "| greedy |" in Path("pages/board.md").read_text()
    assert capsys.readouterr().err.endswith("pages/board.md: written\n")


def test_missions_and_policies_are_listed(capsys):
    """By name, with what they are."""
    assert bench("--list") == exit_codes.OK
    shown = capsys.readouterr().out
    assert all(name in shown for name in (*names(), "fixed-rate", "paper"))


def test_a_recording_becomes_a_mission(place, capsys):
    """Of the robots, the specs and their limit; and can be flown."""
    pytest.importorskip("scipy")
    Path("spec.toml").write_text(spec())
    told = [*samples(30), *samples(30, key="r2/camera")]
    rows = [f"{each.t},{each.robot},{each.key},{each.size},{each.features['red']}" for each in told]
    Path("traffic.csv").write_text("\n".join(["t_gen,robot,key,size,red", *rows]) + "\n")
    assert main(["import", "traffic.csv", "-o", "traffic.mcap"]) == exit_codes.OK
    made = ("--make", "made.jsonl", "--recording", "traffic.mcap")
    assert bench(*made) == exit_codes.FAILED
    assert "name utility specs with --specs" in capsys.readouterr().err
    assert bench(*made, "--specs", "spec.toml", "--latency", "0.1 s", "--about", "two cameras") == exit_codes.OK
    head = json.loads(Path("made.jsonl").read_text().splitlines()[0])
    assert (head["name"], head["about"], head["latency"]) == ("made", "two cameras", 0.1)
    assert 0.0 < head["bound"] < head["all"] * 1.0001
    assert len(Path("made.jsonl").read_text().splitlines()) == 1 + 2 + len(told)
    assert bench("--missions", "made.jsonl", "--only", "--policy", "greedy", "--jobs", 1) == exit_codes.OK
    assert place.joinpath("made.jsonl").exists()


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--missions", "nothing"), 'there is no mission "nothing"'),
        (("--missions", "nowhere.jsonl"), "nowhere.jsonl cannot be read"),
        (("--missions", "small.jsonl", "copy.jsonl"), "two of the missions have the same name"),
        (("--policy", "mine.py:Nobody"), 'mine.py has no class "Nobody"'),
        (("--only",), "--only flies what --policy names"),
        (("--make", "made.jsonl"), "--make FILE and --recording FILE go together"),
        (("--make", "made.json", "--recording", "x.mcap"), "the file of a mission ends in .jsonl"),
        (("--make", "made.jsonl", "--recording", "x.mcap"), "x.mcap cannot be read"),
    ],
)
def test_what_is_wrong_is_said(capsys, arguments, said):
    """In one line, and nothing is printed."""
    write(Path("copy.jsonl"), lines())
    assert bench(*arguments) == exit_codes.FAILED
    shown = capsys.readouterr()
    assert shown.err.startswith("sendworthy bench: ")
    assert said in shown.err
    assert not shown.out


@pytest.mark.parametrize(("option", "value"), [("--jobs", "0"), ("--latency", "soon")])
def test_wrong_arguments_are_refused(capsys, option, value):
    """Before anything is read."""
    with pytest.raises(SystemExit):
        bench(f"{option}={value}")
    assert value in capsys.readouterr().err


@pytest.mark.usefixtures("place")
def test_without_the_extra_for_recordings_it_says_which_to_install(monkeypatch, capsys):
    """All else works without."""
    monkeypatch.setitem(sys.modules, "studies.bench.recorded", None)
    assert bench("--make", "made.jsonl", "--recording", "x.mcap") == exit_codes.FAILED
    assert 'needs the extra "record": pip install "sendworthy[record]"' in capsys.readouterr().err


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize("flag", ["--json", "--leaderboard"])
def test_files_that_cannot_be_written_are_named_before_anything_is_flown(capsys, flag):
    """Not after minutes, in place of the scores."""
    assert bench("--missions", "small.jsonl", flag, "small.jsonl/x") == exit_codes.FAILED
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("", "sendworthy bench: small.jsonl/x: Not a directory\n")
