"""Footage of one's own in place of the drawn world: a folder of images or a video for each robot.

`DIR` holds a folder of images or a video for each robot, in the order of their names; or images themselves, which then
all robots replay, each from another place on. Images and videos begin anew when they are over. Images come ten times a
second; of videos the frames that are due.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from studies.demo.processes import DemoError
from studies.demo.scene import HEIGHT, PERIOD, WIDTH, Frame, Image, encode, red_fraction

STILLS = (".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp")
VIDEOS = (".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".webm")


@dataclass(frozen=True, slots=True)
class Footage:
    """What one robot replays: a video, or a folder of images; from the part `offset` of it on."""

    path: Path
    offset: float = 0.0


def find_footage(folder: Path) -> list[Path]:
    """Return what robots replay, in the order of its names. Raises DemoError for what is no footage."""
    if not folder.is_dir():
        raise DemoError(f"--footage {folder}: there is no such folder")
    entries = sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    found = [entry for entry in entries if entry.is_dir() or entry.suffix.lower() in VIDEOS]
    if not found:
        found = [folder]
    elif len(found) < len(entries):
        odd = next(entry for entry in entries if entry not in found)
        raise DemoError(f"--footage {odd}: neither a folder of images nor a video ({', '.join(VIDEOS)})")
    for each in found:
        open_footage(Footage(each)).close()
    return found


def share(found: Sequence[Path], robots: int) -> list[Footage]:
    """Give each robot its footage; where there is less, robots share it and begin at different places."""
    turns = -(-robots // len(found))
    return [Footage(found[robot % len(found)], robot // len(found) / turns) for robot in range(robots)]


class Stills:
    """The images of a folder, in the order of their names. Raises DemoError for a file that is none."""

    def __init__(self, footage: Footage) -> None:
        self._files = sorted(file for file in footage.path.iterdir() if not file.name.startswith("."))
        if not self._files:
            raise DemoError(f"--footage {footage.path}: the folder is empty")
        for file in self._files:
            if not file.is_file() or not cv2.haveImageReader(str(file)):
                raise DemoError(f"--footage {file}: not an image ({', '.join(STILLS)})")
        self._first = int(footage.offset * len(self._files))

    def frame(self, number: int) -> Frame:
        """Return a frame by its number, from 0. Raises DemoError for an image that cannot be read."""
        file = self._files[(self._first + number) % len(self._files)]
        image = cv2.imread(str(file), cv2.IMREAD_COLOR)
        if image is None:
            raise DemoError(f"--footage {file}: the image is broken")
        return _frame(np.asarray(image, dtype=np.uint8))

    def close(self) -> None:
        """Nothing is open."""


class Video:
    """A video. Raises DemoError for a file that is none."""

    def __init__(self, footage: Footage) -> None:
        self._path = footage.path
        self._video = cv2.VideoCapture(str(footage.path))
        rate = self._video.get(cv2.CAP_PROP_FPS)
        self._step = max(rate, 1.0) * PERIOD
        self._left, self._image = 0.0, self._next()
        self._first = footage.offset * self._video.get(cv2.CAP_PROP_FRAME_COUNT)
        self._video.set(cv2.CAP_PROP_POS_FRAMES, int(self._first))

    def frame(self, number: int) -> Frame:  # noqa: ARG002 - a video is read in its order
        """Return the next frame."""
        self._left += self._step
        while self._left >= 1.0:
            self._left -= 1.0
            self._image = self._next()
        return _frame(self._image)

    def close(self) -> None:
        """Close the file."""
        self._video.release()

    def _next(self) -> Image:
        """Read on, from the start where it is over."""
        there, image = self._video.read()
        if not there:
            self._video.set(cv2.CAP_PROP_POS_FRAMES, 0)
            there, image = self._video.read()
        if not there:
            raise DemoError(f"--footage {self._path}: not a video that OpenCV can read")
        return np.asarray(image, dtype=np.uint8)


def open_footage(footage: Footage) -> Stills | Video:
    """Open what a robot replays. Raises DemoError."""
    return Stills(footage) if footage.path.is_dir() else Video(footage)


def _frame(image: Image) -> Frame:
    """Make an image as large as a camera's, with black beside it where its shape is another."""
    height, width = image.shape[:2]
    if (height, width) != (HEIGHT, WIDTH):
        scale = min(HEIGHT / height, WIDTH / width)
        size = max(1, round(scale * width)), max(1, round(scale * height))
        whole = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        top, left = (HEIGHT - size[1]) // 2, (WIDTH - size[0]) // 2
        whole[top : top + size[1], left : left + size[0]] = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
        image = whole
    return Frame(encode(image), red_fraction(image))
