"""The picture of the operator's screens."""

import cv2
import numpy as np
import pytest

from studies.demo.events import Publish, Receive, Run
from studies.demo.mosaic import TILE, draw
from studies.demo.recording import recordings


def test_both_screens_are_drawn_with_a_frame_per_robot(tmp_path):
    """A robot that sees red has a red border; one whose frames never came a dark tile."""
    robots = ("r1", "r2", "r3")
    events = []
    folders = {}
    for phase in ("without", "with"):
        folders[phase] = tmp_path / phase
        folders[phase].mkdir()
        cv2.imwrite(str(folders[phase] / "r1.jpg"), np.full((480, 640, 3), 200, np.uint8))
        events.append(Run(phase, 0.0, 4.0, robots, 3e6, 2.7e6, 1.0))
        events += [Publish(phase, robot, 0, 1.0, 35_000, 0.3 if robot == "r1" else 0.0) for robot in robots]
        events.append(Receive(phase, "r1", 0, 1.2, 1.0, 35_000))
    draw(folders, recordings(events), 2.0, tmp_path / "picture.png")
    picture = cv2.imread(str(tmp_path / "picture.png")).astype(int)
    assert picture.shape[0] > 2 * TILE[1]
    assert picture.shape[1] > 4 * TILE[0]
    borders = (picture[..., 2] > 200) & (picture[..., :2].max(axis=2) < 80)
    assert borders[:, : picture.shape[1] // 2].sum() > 2 * (TILE[0] + TILE[1])
    assert borders[:, picture.shape[1] // 2 :].sum() > 2 * (TILE[0] + TILE[1])


def test_a_picture_that_cannot_be_written_is_an_error(tmp_path):
    """The demo says so instead of going on without."""
    events = [Run("with", 0.0, 4.0, ("r1",), 3e6, 2.7e6, 1.0), Publish("with", "r1", 0, 1.0, 35_000, 0.0)]
    with pytest.raises(OSError, match="cannot write the picture"):
        draw({"with": tmp_path}, recordings(events), 2.0, tmp_path / "nowhere" / "picture.png")
