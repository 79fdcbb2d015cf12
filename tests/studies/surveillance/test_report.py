"""The page of the surveillance mission, of flights made by hand."""

from datetime import UTC, datetime

import cv2
import numpy as np
import pytest

from studies.demo.events import Counts, Publish, Receive, Run, write_events
from studies.surveillance.__main__ import main
from studies.surveillance.delays import Delay
from studies.surveillance.flying import MISSIONS, WAYS, Mission, fly, kept
from studies.surveillance.report import write_report

MISSION = Mission(2, 1.5e6)


def keep(store, mission, way, every):
    """Write a flight of which every so many frames arrived 0.1 s after it was published."""
    folder = mission.folder(store, way)
    folder.mkdir(parents=True)
    robots = [f"r{number + 1}" for number in range(mission.robots)]
    events = [Run(way, 100.0, 30.0, tuple(robots), mission.rate, 0.9 * mission.rate, 0.95)]
    for robot in robots:
        for number in range(300):
            t, red = 100.0 + 0.1 * number, 0.3 if number // 50 % 3 == 1 else 0.01
            events.append(Publish(way, robot, number, t, 35_000, red))
            if number % every == 0:
                events.append(Receive(way, robot, number, t + 0.1, t, 35_000))
        cv2.imwrite(str(folder / f"{robot}.jpg"), np.full((480, 640, 3), 90, np.uint8))
    if way == "with":
        events += [Counts(way, robot, 300, 300, 0, 0) for robot in robots]
    write_events(folder / "events", events)
    (folder / "busy.json").write_text("[0.5, 1.25]")


@pytest.fixture
def store(tmp_path):
    """A store in which one mission was flown all ways."""
    for place, way in enumerate(WAYS):
        keep(tmp_path / "store", MISSION, way, 5 - place)
    return tmp_path / "store"


@pytest.mark.full
def test_the_page_tells_of_every_way_and_shows_pictures(store, tmp_path):
    """Tables with a row for each, the characteristic, the screens, the delays."""
    page = tmp_path / "page" / "surveillance.md"
    delay = Delay("stock routers", 10, 1, (0.001, 0.002), (0.003, 0.0044), 0, 0.0, 0.0)
    write_report(page, list(kept(store, [MISSION])), [delay], datetime(2026, 1, 1, tzinfo=UTC))
    text = page.read_text()
    assert "## 2 robots, 1.5 Mbit/s" in text
    for name in ("stock routers", "downsampled", "at random", "Sendworthy"):
        (row,) = [line for line in text.splitlines() if line.startswith(f"| {name} ") and "0.10" in line]
        assert row.count("|") == 13
    assert "16.8 Mbit/s offered" not in text
    assert "5.6 Mbit/s offered, 4 times a robot met something red." in text
    assert "4.4 |" in text
    assert "50 |                  1.25 |" in text
    for picture in ("surveillance-characteristic.png", "surveillance-screens.jpg"):
        assert f"({picture})" in text
        assert cv2.imread(str(page.parent / picture)) is not None


def test_what_is_kept_is_not_flown_again(store):
    """And what was not flown is left out."""
    told = []
    assert fly(store, [MISSION], 0.0, told.append)
    assert told == []
    assert [flight.way for flight in kept(store, MISSIONS)] == list(WAYS)


def test_no_run_begins_when_the_time_is_over(tmp_path):
    """The next call goes on."""
    told = []
    assert not fly(tmp_path, MISSIONS, -1.0, told.append)
    assert told == []


@pytest.mark.full
def test_the_command_writes_the_page_of_what_is_there(store, tmp_path):
    """It flies nothing when told so."""
    page = tmp_path / "surveillance.md"
    assert main(["--only", "page", "--store", str(store), "--page", str(page)]) == 0
    assert "python -m studies.surveillance" in page.read_text()
