"""`sendworthy import` and `sendworthy replay`, from files to reports."""

import json
import re
import shlex
from dataclasses import replace
from pathlib import Path

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Drop
from proxy.recording.entries import SpecsText
from proxy.recording.output import text_of
from proxy.recording.writing import RecordingWriter
from studies.replay.table import quantity, span
from studies.simulation.missions import specs_of
from tests.proxy.recording.lives import START, published, recorded
from tests.studies.foreign.rosbags_written import write_bag
from tests.studies.replay.traffic import POSE, samples, spec

FIGURES = {
    "messages",
    "forwarded",
    "bytes",
    "utility",
    "utility_all",
    "bound",
    "violations",
    "seconds_per_decision",
}


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


def replay(*arguments, file="traffic.mcap"):
    code = main(["replay", "--json", "found.json", *map(str, arguments), file])
    return code, json.loads(Path("found.json").read_text()) if code == exit_codes.OK else None


@pytest.mark.full
@pytest.mark.usefixtures("place")
def test_what_would_have_been_done_is_told_in_figures(capsys):
    """Altogether and by type, beside a bound that nothing exceeds."""
    code, found = replay("--specs", "spec.toml")
    assert code == exit_codes.OK
    assert found.keys() >= FIGURES
    assert set(found["types"]) == {"camera", "pose", "(no spec)"}
    for figures in found["types"].values():
        assert figures.keys() >= FIGURES
        assert figures["utility"] <= figures["bound"] * (1 + 1e-6)
        assert figures["forwarded"] <= figures["messages"]
        assert sum(figures["reasons"].values()) == figures["messages"]
    assert found["messages"] == 180
    assert found["violations"] == 0
    assert 0 < found["utility"] <= found["bound"]
    assert found["utility"] == pytest.approx(sum(each["utility"] for each in found["types"].values()))
    assert sum(piece["utility"] for piece in found["pieces"]) == pytest.approx(found["utility"])
    assert sum(piece["utility"] for piece in found["course"]) == pytest.approx(found["utility"])
    assert sum(each["messages"] for each in found["differences"]) == found["messages"] - found["forwarded"]
    assert {each["recorded"] for each in found["differences"]} == {"published"}
    shown = capsys.readouterr().out
    assert "Traffic of r1, r2, flown anew by the policy planner" in shown
    assert "camera" in shown
    assert "published -> dropped:" in shown
    _, _, *lines = shown.partition("\ntype ")[2].splitlines()
    assert lines[-1]
    assert max(map(len, lines)) <= 80, "they break in a terminal of that width"


@pytest.mark.usefixtures("place")
@pytest.mark.full
def test_other_limits_robots_and_policies_are_tried():
    """More room is worth more; without a bound there is none."""
    _, narrow = replay("--specs", "spec.toml", "--no-bound")
    _, wide = replay("--specs", "spec.toml", "--no-bound", "--limit", "1 Mbit/s")
    assert narrow["bound"] is None
    assert wide["utility"] > narrow["utility"]
    assert wide["forwarded"] == wide["messages"]
    assert wide["limits"][0]["limit"] == 125_000.0
    _, one = replay("--specs", "spec.toml", "--no-bound", "--robots", "r1")
    assert one["robots"] == ["r1"]
    assert one["messages"] == 60
    _, everything = replay("--specs", "spec.toml", "--no-bound", "--policy", "all", "--robots", "r1,r2")
    assert everything["forwarded"] == 180
    assert everything["violations"] > 0
    _, again = replay("--specs", "spec.toml", "--no-bound")
    for each in (narrow, again):
        each.pop("seconds_per_decision")
        for figures in each["types"].values():
            figures.pop("seconds_per_decision")
    assert narrow == again


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize("policy", [pytest.param("planner", marks=pytest.mark.full), "fits"])
def test_loss_is_tried(policy, capsys):
    """What is sent in vain is counted, and the bound still holds."""
    _, kept = replay("--specs", "spec.toml", "--policy", policy)
    capsys.readouterr()
    _, found = replay("--specs", "spec.toml", "--policy", policy, "--loss", "0.3")
    told = capsys.readouterr().out
    assert "10 ms away, 0.3 of it lost." in told
    assert f"{found['lost']} of the {found['forwarded']} samples sent were lost on the way" in told
    assert kept["lost"] == 0
    assert 0 < found["lost"] < found["forwarded"]
    assert found["utility"] < 0.95 * kept["utility"]
    assert found["utility"] < found["bound"]
    assert found["loss"] == 0.3


@pytest.mark.full
@pytest.mark.usefixtures("place")
def test_adaptive_limits_are_not_guessed(capsys):
    """Mere traffic says nothing of the channel; a throughput of one's own does."""
    text = Path("spec.toml").read_text()
    Path("adaptive.toml").write_text(text.replace('limit = "8 kbit/s"', 'limit = "adaptive"\nceiling = "80 kbit/s"'))
    assert replay("--specs", "adaptive.toml", "--no-bound")[0] == exit_codes.FAILED
    assert "the limit throughput is adaptive" in capsys.readouterr().err
    assert replay("--specs", "adaptive.toml", "--no-bound", "--limit", "8 kbit/s")[1]["violations"] == 0


@pytest.mark.usefixtures("place")
def test_of_limits_that_cannot_be_read_nobody_knows_what_the_channel_bore(capsys):
    """Other specs are named already; a throughput is what helps."""
    text = Path("spec.toml").read_text()
    Path("adaptive.toml").write_text(text.replace('limit = "8 kbit/s"', 'limit = "adaptive"\nceiling = "80 kbit/s"'))
    with RecordingWriter(Path("r1.mcap"), replace(START, generation="lost")) as writer:
        writer.specs(SpecsText("lost"))
        for number in range(3):
            writer.happened(published(number), [{"command": "SendDigest", "digest": {"capacity": [0.5]}}])
    asked = ("--specs", "adaptive.toml", "--policy", "planner", "--no-bound")
    assert replay(*asked, file="r1.mcap")[0] == exit_codes.FAILED
    told = capsys.readouterr().err
    assert "--limit names a throughput instead" in told
    assert "--specs names others" not in told


@pytest.mark.full
def test_the_page_needs_nothing_else(place):
    """One file without anything from elsewhere, whatever names are in it."""
    (place / "traffic.mcap").rename("<b>.mcap")
    code, _ = replay("--specs", "spec.toml", "--html", "page.html", file="<b>.mcap")
    assert code == exit_codes.OK
    page = Path("page.html").read_text()
    assert not re.findall(r"https?:|//\w|<script|<img|<link|@import|url\((?!#)", page)
    assert "<b>" not in page
    assert page.count("<svg") == page.count("</svg>") == 1
    for text in ("Utility gained", "offline bound", "What became of the samples", "Age at the receiver"):
        assert text in page


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize("flag", ["--json", "--html"])
def test_files_that_cannot_be_written_are_named_before_anything_is_flown(capsys, flag):
    """Not after minutes, in place of the table."""
    capsys.readouterr()
    assert main(["replay", "traffic.mcap", "--specs", "spec.toml", flag, "none/x"]) == exit_codes.FAILED
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("", "sendworthy replay: none/x: No such file or directory\n")


@pytest.mark.full
@pytest.mark.usefixtures("place")
def test_json_may_go_where_the_table_would(capsys):
    """For scripts."""
    capsys.readouterr()
    assert main(["replay", "traffic.mcap", "--specs", "spec.toml", "--no-bound", "--json", "-"]) == exit_codes.OK
    assert json.loads(capsys.readouterr().out)["messages"] == 180


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        ([], exit_codes.FAILED, "name utility specs with --specs"),
        (
            ["--specs", "spec.toml", "--robots", "r7"],
            exit_codes.FAILED,
            'no robot "r7" published anything; there are r1, r2',
        ),
        (["--specs", "none.toml"], exit_codes.CONFIG, "none.toml"),
        (
            ["--specs", "far.toml"],
            exit_codes.FAILED,
            "the specs cover no key of this traffic; it has r1/camera, r2/other",
        ),
    ],
)
@pytest.mark.usefixtures("place")
def test_what_cannot_be_flown_is_told(capsys, arguments, code, message):
    """With what to do."""
    Path("far.toml").write_text(spec().replace("*/camera", "far/away"))
    assert main(["replay", "traffic.mcap", *arguments]) == code
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [["--limit", "2"], ["--iterations", "0"], ["--latency", "x"], ["--loss", "1"], ["--loss", "x"], ["--policy", "y"]],
)
def test_senseless_arguments_are_refused(arguments, capsys):
    """Before anything is read."""
    with pytest.raises(SystemExit):
        main(["replay", "traffic.mcap", *arguments])
    assert arguments[0] in capsys.readouterr().err


@pytest.mark.usefixtures("place")
def test_the_words_of_traffic_cannot_command_the_terminal(capsys):
    """Robots, keys and reasons are whatever the file says."""
    with RecordingWriter(Path("wild.mcap"), replace(START, robot="r\x1b[2J")) as writer:
        writer.specs(SpecsText("\x1b[2J"))
        for number, key in enumerate(("a/pose", "\x1b[2J")):
            writer.happened(replace(published(number), key=key), [Drop(number, "dropped:\x1b[2J")])
    Path("none.toml").write_text(POSE.replace("*/pose", "none"))
    flown = ["replay", "wild.mcap", "--no-bound", "--specs"]
    assert main([*flown, "spec.toml"]) == exit_codes.OK
    assert main([*flown, "spec.toml", "--robots", "r1"]) == exit_codes.FAILED
    assert main([*flown, "none.toml"]) == exit_codes.FAILED
    assert main(["study", "characteristic", "wild.mcap", "--specs", "none.toml"]) == exit_codes.FAILED
    assert main(["bench", "--make", "made.jsonl", "--recording", "wild.mcap"]) == exit_codes.FAILED
    shown = capsys.readouterr()
    assert "Traffic of r\ufffd[2J" in shown.out
    assert "dropped:\ufffd[2J -> forwarded" in shown.out
    assert "there are r\ufffd[2J" in shown.err
    assert shown.err.count("it has \ufffd[2J, a/pose") == 2
    assert "bench: the text of the specs \ufffd[2J is not" in shown.err
    assert "\x1b" not in shown.out + shown.err


@pytest.mark.full
@pytest.mark.usefixtures("place")
def test_what_is_named_twice_counts_once(tmp_path, capsys):
    """Flown anew, replayed exactly, and in a study or a mission of it."""
    code, found = replay("--specs", "spec.toml", "--no-bound", "./traffic.mcap")
    assert code == exit_codes.OK
    assert (found["messages"], found["files"]) == (180, ["traffic.mcap"])
    path, core = tmp_path / "r1.mcap", Core(START.settings, specs_of(POSE), START.now)
    with RecordingWriter(path, replace(START, generation=specs_of(POSE).generation)) as writer:
        writer.specs(text_of(specs_of(POSE)))
        writer.happened(ev.TimePassed(1.5), core.handle(ev.TimePassed(1.5)))
    assert main(["replay", "r1.mcap", str(path)]) == exit_codes.OK
    assert "1 events, all equal\n" in capsys.readouterr().out
    twice = [str(tmp_path / "traffic.mcap"), "traffic.mcap"]
    assert main(["study", "characteristic", *twice, "--specs", "spec.toml"]) == exit_codes.OK
    assert "180 samples of 2 robots" in capsys.readouterr().out
    made = ["--make", "made.jsonl", "--specs", "spec.toml"]
    assert main(["bench", *made, "--recording", *twice]) == exit_codes.OK
    assert "made.jsonl: 120 samples of 2 robots" in capsys.readouterr().err


def test_a_robots_recording_is_flown_anew_only_where_something_else_is_tried(tmp_path, monkeypatch):
    """Features that were not recorded are told."""
    monkeypatch.chdir(tmp_path)
    path = recorded(tmp_path / "r1.mcap", 200)
    Path("spec.toml").write_text(spec().replace("*/camera", "robot/*/camera").replace("red", "blue"))
    code, found = replay("--specs", "spec.toml", "--no-bound", file=str(path))
    assert code == exit_codes.OK
    assert found["messages"] == 200
    assert found["notes"] == ["the feature camera.blue of 200 samples was not recorded, and has its default"]
    assert not found["exact"]


def test_a_recording_that_is_replayed_as_it_was_has_figures_of_that(tmp_path, capsys):
    """Of what was decided then; what the exact replay found is said besides."""
    flown = specs_of(spec().replace("*/camera", "robot/*/camera"))
    begin = replace(START, generation=flown.generation)
    core, path = Core(begin.settings, flown, begin.now), tmp_path / "r1.mcap"
    with RecordingWriter(path, begin) as writer:
        writer.specs(text_of(flown))
        for event in [ev.PeerAppeared(1.0, "r2", "z2"), *(published(number) for number in range(5))]:
            writer.happened(event, core.handle(event))
    assert main(["replay", str(path), "--json", "-", "--no-bound"]) == exit_codes.OK
    shown = capsys.readouterr()
    assert "6 events, all equal" in shown.err
    found = json.loads(shown.out)
    assert found["exact"]
    assert found["messages"] == 5
    assert found["forwarded"] + sum(n for r, n in found["reasons"].items() if r != "forwarded") == 5
    assert found["differences"] == []


def test_the_commands_of_the_readme(tmp_path, monkeypatch, capsys):
    """What would Sendworthy have done with my bag? Two commands answer it."""
    readme = (Path(__file__).parents[3] / "README.md").read_text()
    (block,) = [each for each in re.findall(r"```sh\n(.*?)```", readme, re.DOTALL) if "sendworthy import" in each]
    monkeypatch.chdir(tmp_path)
    write_bag(tmp_path / "my_bag")
    Path("utility_specs").symlink_to(Path(__file__).parents[3] / "utility_specs")
    commands = [shlex.split(line, comments=True) for line in block.splitlines()]
    assert [words[:2] for words in commands] == [["sendworthy", each] for each in ("import", "replay", "study")]
    for words in commands:
        assert main(words[1:]) == exit_codes.OK
    shown = capsys.readouterr().out
    assert "my_bag.mcap: 90 samples of my_bag (90) on 3 keys, 2.9 s" in shown
    assert "batteries" in shown
    assert "<svg" in Path("my_bag.html").read_text()
    assert Path("characteristic.png").exists()


def test_quantities_are_short():
    """As people say them."""
    assert [quantity(each) for each in (0, 999, 1234, 5.6e6, 7.8e12)] == [
        "0 B",
        "999 B",
        "1.23 kB",
        "5.6 MB",
        "7.8e+03 GB",
    ]
    assert [span(each) for each in (None, 0.0123, 1.26)] == ["-", "12 ms", "1.3 s"]
