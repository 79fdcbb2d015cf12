"""`sendworthy demo` as a whole, on a short run with real processes."""

import json
import os
import signal
import subprocess
import sys
import uuid
from pathlib import Path

import cv2
import numpy as np
import pytest

from proxy.cli import main
from studies.demo.events import Links, Publish, read_events
from studies.demo.figures import figures
from tests.waiting import wait_until

PROMISED = {
    *(f"{name}_{kind}" for name in ("age_p50", "age_p95", "staleness_p95", "fps") for kind in ("red", "other")),
    "medium_bytes",
    "utility_share",
    "conserved",
    "direct_links",
}


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    """A short demo: its figures, its events, its picture."""
    folder = tmp_path_factory.mktemp("demo")
    files = {name: folder / f"demo.{name}" for name in ("json", "events", "png")}
    arguments = ["demo", "--robots", "2", "--seconds", "5", "--rate", "1.5e6", "--json", str(files["json"])]
    arguments += ["--events", str(files["events"]), "--picture", str(files["png"])]
    assert main(arguments) == 0
    return files


@pytest.mark.full
def test_the_figures_of_all_runs_are_written(demo):
    """All that was promised, and the filter keeps red frames fresher than the same run without it."""
    found = json.loads(demo["json"].read_text())
    assert list(found) == ["without", "downsampled", "with"]
    assert all(set(figures) >= PROMISED for figures in found.values())
    assert found["with"]["conserved"] is True
    assert found["with"]["age_p95_red"] < found["without"]["age_p95_red"]
    assert found["with"]["utility_share"] > found["without"]["utility_share"]


@pytest.mark.full
@pytest.mark.parametrize("phase", ["without", "downsampled", "with"])
def test_nothing_goes_around_the_medium(demo, phase):
    """No connection, and no byte, reaches the operator but through it; and it keeps its rate."""
    found = json.loads(demo["json"].read_text())[phase]
    assert found["direct_links"] == 0
    assert found["direct_bytes"] == 0
    assert 0 < found["received_bytes"] <= found["medium_bytes"] <= 1.1 * 5 * 1.5e6 / 8


@pytest.mark.full
def test_every_pair_is_linked_through_the_medium(demo):
    """The operator and two robots make three pairs, each with a connection on either side of the medium."""
    looks = [event for event in read_events(demo["events"]) if isinstance(event, Links)]
    assert {look.phase for look in looks} == {"without", "downsampled", "with"}
    assert {look.medium for look in looks} == {6}


@pytest.mark.full
def test_every_figure_can_be_recomputed_from_the_events(demo):
    """The events alone say the same."""
    assert figures(read_events(demo["events"])) == json.loads(demo["json"].read_text())


@pytest.mark.full
def test_the_picture_shows_the_screens(demo):
    """It is there and can be read."""
    assert cv2.imread(str(demo["png"])) is not None


@pytest.mark.full
def test_an_interrupted_demo_leaves_no_process(tmp_path):
    """SIGTERM ends everything that the demo has started."""
    mark = f"DEMO_TEST={uuid.uuid4()}"
    environment = os.environ | dict([mark.split("=")]) | {"PYTHONPATH": os.pathsep.join(sys.path)}
    command = [
        sys.executable,
        "-u",
        "-m",
        "proxy.cli",
        "demo",
        "--robots",
        "1",
        "--picture",
        str(tmp_path / "x.png"),
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        wait_until(lambda: "frames received" in process.stdout.readline(), what="the first progress")
        assert len(marked(mark)) > 4
        process.send_signal(signal.SIGTERM)
        assert process.wait(60.0) == 130
    assert marked(mark) == []


@pytest.mark.parametrize(
    ("flag", "value"),
    [
        *(("--robots", "0"), ("--robots", "17"), ("--robots", "many"), ("--robots", "nan"), ("--robots", "2.5")),
        *(("--seconds", "1"), ("--seconds", "inf"), ("--seconds", "soon"), ("--rate", "10"), ("--rate", "3 Mbit/s")),
        *(("--latency", "-1"), ("--latency", "6"), ("--loss", "1"), ("--loss", "few")),
    ],
)
def test_impossible_conditions_are_refused(flag, value, capsys):
    """With the flag and what is wrong."""
    with pytest.raises(SystemExit):
        main(["demo", flag, value])
    assert f"argument {flag}: {value} is not " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--footage", "nowhere"], "--footage nowhere: there is no such folder"),
        (["--live", "--json", "figures.json"], "--json: a live mission has no figures; leave out --live"),
        (["--live", "--events", "events.jsonl"], "--events: a live mission has no figures; leave out --live"),
    ],
)
def test_what_cannot_be_shown_is_said_at_once(arguments, words, capsys, tmp_path, monkeypatch):
    """Before anything is started."""
    monkeypatch.chdir(tmp_path)
    assert main(["demo", *arguments]) == 1
    assert capsys.readouterr().err == f"sendworthy demo: {words}\n"


@pytest.mark.full
def test_footage_of_ones_own_is_shown(tmp_path):
    """Two folders of images are two robots; what is red in them is red."""
    for robot, colour in (("one", (20, 20, 220)), ("two", (90, 90, 90))):
        (tmp_path / "films" / robot).mkdir(parents=True)
        cv2.imwrite(str(tmp_path / "films" / robot / "1.png"), np.full((120, 160, 3), colour, np.uint8))
    files = [str(tmp_path / name) for name in ("figures.json", "events.jsonl", "picture.png")]
    arguments = ["demo", "--footage", str(tmp_path / "films"), "--seconds", "3", "--json", files[0]]
    assert main([*arguments, "--events", files[1], "--picture", files[2]]) == 0
    red = {event.robot: event.red for event in read_events(Path(files[1])) if isinstance(event, Publish)}
    assert red == {"r1": pytest.approx(1.0), "r2": pytest.approx(0.0)}
    assert json.loads(Path(files[0]).read_text())["with"]["fps_red"] > 0


def marked(mark):
    """Return the ids of all processes whose environment carries the mark."""
    found = []
    for environment in Path("/proc").glob("[0-9]*/environ"):
        try:
            if mark.encode() in environment.read_bytes():
                found.append(int(environment.parent.name))
        except OSError:
            continue
    return found


@pytest.mark.parametrize(
    ("flag", "name", "problem"),
    [
        ("--json", "none/demo.json", "{}: No such file or directory"),
        ("--events", ".", "{}: Is a directory"),
        ("--picture", "none/demo.png", "{}: No such file or directory"),
        ("--picture", "demo.doc", "--picture {}: a picture is a file such as demo.png or demo.jpg"),
        ("--picture", "demo", "--picture {}: a picture is a file such as demo.png or demo.jpg"),
    ],
)
def test_files_that_cannot_be_written_are_named_before_the_mission(tmp_path, capsys, flag, name, problem):
    """Not after a minute and a half, in place of the figures."""
    assert main(["demo", "--picture", str(tmp_path / "demo.png"), flag, str(tmp_path / name)]) == 1
    shown = capsys.readouterr()
    assert not shown.out
    assert shown.err == f"sendworthy demo: {problem.format(tmp_path / name)}\n"
