"""What the operator sees: the screen at one moment of each run, side by side."""

import math
from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from studies.demo.nodes import DOWNSAMPLED, RANDOM, WITH, WITHOUT
from studies.demo.recording import Feed, Recording
from studies.demo.world import LATELY

Image = npt.NDArray[np.uint8]

TILE = (400, 300)
"""Width and height of a robot's frame [pixels]."""
CAPTION, TITLE, GAP = 30, 44, 24
"""Heights of the text under a frame and above a screen, and the space between the screens [pixels]."""
TITLES = {
    WITHOUT: "without Sendworthy",
    DOWNSAMPLED: "downsampled by Zenoh",
    RANDOM: "dropped at random",
    WITH: "with Sendworthy",
}
WHITE, GREY, RED, INK = (255, 255, 255), (90, 90, 90), (40, 40, 230), (30, 30, 30)


def is_picture(path: Path) -> bool:
    """Whether a file of this name can be drawn."""
    return bool(cv2.haveImageWriter(str(path)))


def draw(photographs: Mapping[str, Path], recordings: Mapping[str, Recording], at: float, path: Path) -> None:
    """Draw all screens as of the time `at` [s]; `photographs` holds the folder of frames for each phase."""
    screens = [_screen(phase, recordings[phase], folder, at) for phase, folder in photographs.items()]
    gap = np.full((screens[0].shape[0], GAP, 3), 255, np.uint8)
    parts = [part for screen in screens for part in (gap, screen)][1:]
    picture = cv2.copyMakeBorder(cv2.hconcat(parts), 12, 12, 16, 16, cv2.BORDER_CONSTANT, value=WHITE)
    if not cv2.imwrite(str(path), picture):
        raise OSError(f"cannot write the picture {path}")


def _screen(phase: str, recording: Recording, folder: Path, at: float) -> Image:
    tiles = [_tile(feed, folder / f"{feed.robot}.jpg", at) for feed in recording.feeds]
    columns = math.ceil(math.sqrt(len(tiles)))
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % columns)
    rows = [cv2.hconcat(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
    title = np.full((TITLE, columns * tiles[0].shape[1], 3), 255, np.uint8)
    text = f"{TITLES[phase]}, {at:.1f} s"
    cv2.putText(title, text, (6, 30), cv2.FONT_HERSHEY_SIMPLEX, 0.9, INK, 2, cv2.LINE_AA)
    return np.asarray(cv2.vconcat([title, *rows]), dtype=np.uint8)


def _tile(feed: Feed, photograph: Path, at: float) -> Image:
    """One robot's frame; a red border while the robot sees red, whatever is shown."""
    frame = cv2.imread(str(photograph)) if photograph.exists() else None
    tile = np.full((TILE[1], TILE[0], 3), 60, np.uint8) if frame is None else cv2.resize(frame, TILE)
    sees_red = bool(feed.sees_red[max(0, int(np.searchsorted(feed.t_gen, at, side="right")) - 1)])
    caption = np.full((CAPTION, TILE[0], 3), 255, np.uint8)
    text, color = _caption(feed, at, sees_red=sees_red)
    cv2.putText(caption, text, (4, 21), cv2.FONT_HERSHEY_SIMPLEX, 0.6, color, 2 if sees_red else 1, cv2.LINE_AA)
    border = RED if sees_red else GREY
    framed = cv2.copyMakeBorder(np.asarray(tile), 4, 4, 4, 4, cv2.BORDER_CONSTANT, value=border)
    captioned = cv2.copyMakeBorder(caption, 0, 4, 4, 4, cv2.BORDER_CONSTANT, value=WHITE)
    return np.asarray(cv2.vconcat([framed, captioned]), dtype=np.uint8)


def _caption(feed: Feed, at: float, *, sees_red: bool) -> tuple[str, tuple[int, int, int]]:
    shown = int(np.searchsorted(feed.t_rcv, at, side="right"))
    if shown == 0:
        return f"{feed.robot}: nothing yet", INK
    age = at - float(feed.t_gen[feed.frame[shown - 1]])
    rate = (shown - int(np.searchsorted(feed.t_rcv, at - LATELY, side="right"))) / LATELY
    note = ", sees red now" if sees_red else ""
    return f"{feed.robot}: {age:.1f} s old, {rate:.1f} frames/s{note}", RED if sees_red else INK
