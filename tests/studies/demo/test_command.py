"""`sendworthy demo` as a whole, on a short run with real processes."""

import json
import os
import signal
import subprocess
import sys
import uuid
from pathlib import Path

import cv2
import pytest

from proxy.cli import main
from studies.demo.events import Links, read_events
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
    assert found["with"]["utility_share"] > found["downsampled"]["utility_share"] > found["without"]["utility_share"]


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
        *(("--robots", "0"), ("--robots", "51"), ("--robots", "many"), ("--robots", "nan"), ("--robots", "2.5")),
        *(("--seconds", "1"), ("--seconds", "inf"), ("--seconds", "soon"), ("--rate", "10"), ("--rate", "3 Mbit/s")),
    ],
)
def test_impossible_conditions_are_refused(flag, value, capsys):
    """With the flag and what is wrong."""
    with pytest.raises(SystemExit):
        main(["demo", flag, value])
    assert f"argument {flag}: {value} is not " in capsys.readouterr().err


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
