"""What a robot's camera sees of the world: ground and sky, posts, other robots with red wheels, and red objects.

A frame is a pure function of seed, robot, frame number and the red objects that are there, so that two runs publish the
same bytes. Nothing is red but objects and wheels.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
import numpy.typing as npt

from studies.demo.world import Episode, Pose, Post, World, phases
from utility_specs.features.color_fraction import HUES, LEAST_SATURATION, LEAST_VALUE

WIDTH, HEIGHT = 640, 480
PERIOD = 0.1
"""Time between frames of one robot [s]."""
RED = 0.15
"""A frame of which at least this part is red counts as red; other robots' wheels are less."""
QUALITY = 68
"""Of the JPEG; its frames have 30 to 40 kB."""
FOCAL = 500.0
"""Of the camera [pixels]: it sees 65 degrees."""
EYE = 0.7
"""Height of the camera above the ground [m]."""
HORIZON = 205
"""Row of the image at which the horizon is."""
NEAREST = 0.7
"""What is nearer is not in the picture [m]."""
OBJECT = 1.35, 1.7
"""Width and height of a red object [m]."""
TILE, PIXEL = 1024, 0.02
"""The ground repeats itself after so many pixels, of so many metres."""

Image = npt.NDArray[np.uint8]
Singles = npt.NDArray[np.float32]

_ROWS, _COLUMNS = np.mgrid[HORIZON + 1 : HEIGHT : 2, 0:WIDTH:2].astype(np.float32)
AHEAD: Singles = EYE * FOCAL / (_ROWS - HORIZON)
ASIDE: Singles = (_COLUMNS - WIDTH / 2) * AHEAD / FOCAL
"""How far ahead of the camera, and to its right, each second pixel below the horizon looks at the ground [m]."""


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame; `red` is the fraction of its pixels that are red."""

    jpeg: bytes
    red: float


class Film(Protocol):
    """Where a camera has its frames from."""

    def frame(self, number: int) -> Frame:
        """Return a frame by its number, from 0."""


class Scene:
    """What one robot sees. `objects` are red ones; more may be added while it runs."""

    def __init__(self, seed: int, robot: int, robots: int, objects: Iterable[Episode]) -> None:
        rng = np.random.default_rng((seed, 3))
        self._world = World(seed, robots)
        self._robot = robot
        self._phase = phases(seed, robots, PERIOD)[robot]
        self._objects = tuple(objects)
        self._ground, self._sky, self._metal = _ground(rng), _sky(rng), _metal(rng)
        self._grain = rng.integers(0, 20, (HEIGHT + 64, WIDTH + 64, 1), dtype=np.uint8).repeat(3, axis=2)
        self._label = f"r{robot + 1}"

    def add(self, episode: Episode) -> None:
        """Put a red object into some robot's way; those whose time is long over are forgotten."""
        kept = tuple(each for each in self._objects if each.end > episode.start - 1.0)
        self._objects = (*kept, episode)

    def frame(self, number: int) -> Frame:
        """Draw frame `number`."""
        time = self._phase + number * PERIOD
        image = self._backdrop(self._world.pose(self._robot, time))
        self._draw_things(image, time)
        self._grow_grain(image, number)
        red = red_fraction(image)
        text = f"{self._label}  {time:6.1f} s"
        cv2.putText(image, text, (12, HEIGHT - 14), cv2.FONT_HERSHEY_SIMPLEX, 0.8, (0, 0, 0), 5, cv2.LINE_AA)
        cv2.putText(image, text, (12, HEIGHT - 14), cv2.FONT_HERSHEY_SIMPLEX, 0.8, (255, 255, 255), 2, cv2.LINE_AA)
        return Frame(encode(image), red)

    def _backdrop(self, pose: Pose) -> Image:
        """Draw the ground in perspective and the sky above it."""
        image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        place = int(pose.heading / (2.0 * math.pi) * self._sky.shape[1] / 2) % (self._sky.shape[1] // 2)
        image[:HORIZON] = self._sky[:, place : place + WIDTH]
        x, y = (axis / PIXEL for axis in _on_the_ground(pose))
        # Drawn half as fine: so it takes a third of the time, and the grain hides it.
        half = cv2.remap(self._ground, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        cv2.resize(half, (WIDTH, HEIGHT - HORIZON), dst=image[HORIZON:], interpolation=cv2.INTER_LINEAR)
        return image

    def _draw_things(self, image: Image, time: float) -> None:
        """Draw what is in view, what is far first."""
        eye, world = self._world.pose(self._robot, time), self._world
        things: list[tuple[float, float, Post | Pose | Episode, int]]
        things = [(*_seen(eye, post.x, post.y), post, 0) for post in world.posts]
        others = [(other, world.pose(other, time)) for other in range(world.robots) if other != self._robot]
        things += [(*_seen(eye, pose.x, pose.y), pose, other) for other, pose in others]
        there = [episode for episode in self._objects if episode.start <= time < episode.end]
        things += [(*_seen(eye, *world.place(episode)), episode, 0) for episode in there]
        for ahead, aside, thing, number in sorted(things, key=lambda each: -each[0]):
            if ahead >= NEAREST and abs(aside) < ahead + 2.0:
                at, scale = WIDTH / 2 + FOCAL * aside / ahead, FOCAL / ahead
                self._draw(image, thing, number, at, scale)

    def _draw(self, image: Image, thing: Post | Pose | Episode, number: int, at: float, scale: float) -> None:
        """Draw one thing whose middle is in column `at`, at so many pixels a metre."""
        foot = HORIZON + EYE * scale
        if isinstance(thing, Post):
            _draw_post(image, thing, at, foot, scale)
        elif isinstance(thing, Pose):
            _draw_robot(image, number, at, foot, scale)
        else:
            self._draw_object(image, at, foot, scale)

    def _draw_object(self, image: Image, at: float, foot: float, scale: float) -> None:
        """Draw a red canister: a body and a round shoulder."""
        width, height = OBJECT[0] * scale, OBJECT[1] * scale
        mask = np.zeros((HEIGHT, WIDTH), np.uint8)
        shoulder = round(foot - height + width / 4)
        cv2.rectangle(mask, (round(at - width / 2), shoulder), (round(at + width / 2), round(foot)), 255, cv2.FILLED)
        axes = (round(width / 2), round(width / 4))
        cv2.ellipse(mask, (round(at), shoulder), axes, 0, 180, 360, 255, cv2.FILLED)
        cv2.copyTo(self._metal, mask, image)

    def _grow_grain(self, image: Image, number: int) -> None:
        """Add the noise of a sensor, which JPEG must carry: it is another one in each frame."""
        row, column = (7 * number) % 64, (29 * number) % 64
        cv2.add(image, self._grain[row : row + HEIGHT, column : column + WIDTH], dst=image)


def red_fraction(image: Image) -> float:
    """Return which part of an image is red, by the same measure as a spec's `color_fraction`."""
    small = cv2.resize(image, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    hsv = cv2.cvtColor(small, cv2.COLOR_BGR2HSV)
    counted = sum(
        cv2.countNonZero(cv2.inRange(hsv, np.array((low, LEAST_SATURATION, LEAST_VALUE)), np.array((high, 255, 255))))
        for low, high in HUES["red"]
    )
    return float(counted / (hsv.shape[0] * hsv.shape[1]))


def encode(image: Image) -> bytes:
    """Return an image as JPEG."""
    _, jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return jpeg.tobytes()


def _on_the_ground(pose: Pose) -> tuple[Singles, Singles]:
    """Return where on the ground each second pixel below the horizon looks at [m]."""
    cos, sin = np.float32(math.cos(pose.heading)), np.float32(math.sin(pose.heading))
    x, y = np.float32(pose.x) + AHEAD * cos, np.float32(pose.y) + AHEAD * sin
    return x + ASIDE * sin, y - ASIDE * cos


def _seen(eye: Pose, x: float, y: float) -> tuple[float, float]:
    """Return how far ahead of `eye`, and to its right, something is [m]."""
    cos, sin = math.cos(eye.heading), math.sin(eye.heading)
    ahead = (x - eye.x) * cos + (y - eye.y) * sin
    return ahead, (x - eye.x) * sin - (y - eye.y) * cos


COLOURS = ((200, 120, 30), (120, 160, 40), (190, 170, 90), (90, 140, 60), (150, 100, 60), (170, 170, 160))
"""Of what is not red: blue, green, blue, red from 0 to 255."""


def _draw_post(image: Image, post: Post, at: float, foot: float, scale: float) -> None:
    width = (0.15 + 0.5 * post.kind**2) * scale
    colour = COLOURS[int(post.kind * 97) % len(COLOURS)]
    left, right = round(at - width / 2), round(at + width / 2)
    top = round(foot - post.height * scale)
    cv2.rectangle(image, (left, top), (right, round(foot)), colour, cv2.FILLED)
    shade = tuple(part // 2 for part in colour)
    cv2.rectangle(image, (right - round(width / 4), top), (right, round(foot)), shade, cv2.FILLED)


def _draw_robot(image: Image, number: int, at: float, foot: float, scale: float) -> None:
    """Draw another robot: a box with its number between two red wheels."""
    wheel, half = 0.17 * scale, 0.36 * scale
    colour = COLOURS[number % len(COLOURS)]
    top, bottom = round(foot - 0.8 * scale), round(foot - 0.15 * scale)
    cv2.rectangle(image, (round(at - half), top), (round(at + half), bottom), colour, cv2.FILLED)
    cv2.rectangle(image, (round(at - half), top), (round(at + half), bottom), (40, 40, 40), max(1, round(0.03 * scale)))
    for side in (-1.0, 1.0):
        middle = (round(at + side * half), round(foot - wheel))
        cv2.circle(image, middle, round(wheel), (25, 20, 190), cv2.FILLED, cv2.LINE_AA)
        cv2.circle(image, middle, round(wheel / 3), (60, 60, 60), cv2.FILLED, cv2.LINE_AA)
    size, text = scale / 75.0, f"r{number + 1}"
    thickness = max(1, round(2.0 * size))
    (width, height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, thickness)
    corner = (round(at - width / 2), round((top + bottom + height) / 2))
    cv2.putText(image, text, corner, cv2.FONT_HERSHEY_SIMPLEX, size, (250, 250, 250), thickness, cv2.LINE_AA)


def _ground(rng: np.random.Generator) -> Image:
    """Return a piece of ground in greens and greys that repeats itself without a seam."""
    luma = np.full((TILE, TILE), 105.0, np.float32)
    for cell, amplitude in ((256, 30.0), (64, 24.0), (16, 16.0), (4, 12.0)):
        coarse = rng.uniform(-1, 1, (TILE // cell, TILE // cell)).astype(np.float32)
        padded = np.pad(coarse, 2, mode="wrap")
        size = padded.shape[0] * cell
        fine = cv2.resize(padded, (size, size), interpolation=cv2.INTER_CUBIC)
        luma += amplitude * fine[2 * cell : 2 * cell + TILE, 2 * cell : 2 * cell + TILE]
    ground = np.stack([luma * 0.85, luma * 1.08, luma * 0.95], axis=2)
    return np.asarray(np.clip(ground, 0, 230), dtype=np.uint8)


def _sky(rng: np.random.Generator) -> Image:
    """Return the sky and hills at the horizon, all around twice, so that any piece can be cut out."""
    around = 2048
    shade = np.linspace(205, 170, HORIZON, dtype=np.float32)[:, None]
    coarse = np.pad(rng.uniform(-1, 1, (4, 32)).astype(np.float32), ((0, 0), (2, 2)), mode="wrap")
    clouds = cv2.resize(coarse, (36 * around // 32, HORIZON), interpolation=cv2.INTER_CUBIC)
    luma = shade + 18 * clouds[:, around // 16 : around // 16 + around]
    sky = np.stack([luma, luma * 0.9, luma * 0.78], axis=2)
    angle = np.linspace(0, 2 * math.pi, around, endpoint=False)
    hills = HORIZON - 22 - 9 * np.sin(3 * angle + 1) - 7 * np.sin(7 * angle) - 4 * np.sin(17 * angle + 2)
    sky[np.arange(HORIZON)[:, None] > hills[None, :]] = (110, 118, 92)
    return np.tile(np.asarray(np.clip(sky, 0, 230), dtype=np.uint8), (1, 2, 1))


def _metal(rng: np.random.Generator) -> Image:
    """Return a red surface, shaded from left to right, with a grain like the ground's."""
    shade = 175 + 45 * np.sin(np.linspace(0, 4 * math.pi, WIDTH, dtype=np.float32))
    grain = cv2.resize(rng.normal(0, 1, (HEIGHT // 3, WIDTH // 3)).astype(np.float32), (WIDTH, HEIGHT))
    red = shade + 9 * grain
    metal = np.stack([red * 0.13, red * 0.1, red], axis=2)
    return np.asarray(np.clip(metal, 0, 229), dtype=np.uint8)
