"""What the robots' cameras see: a seeded moving scene in which now and then one robot sees something red.

A frame is a pure function of (seed, robot, frame number), so that two runs publish the same bytes. Nothing in
the scene is red but the object, so the red fraction of a frame is known exactly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

WIDTH, HEIGHT = 640, 480
PERIOD = 0.1
"""Time between frames of one robot [s]."""
SMALLEST, LARGEST = 30_000, 40_000
"""Every frame's size lies between these [B]."""
QUALITIES = (64, 69, 59, 74, 53, 79, 46, 84, 40, 88, 33, 92, 95)
"""JPEG qualities in the order in which they are tried."""
BASE_RED, RED_SWING = 0.275, 0.06
"""The red object fills `BASE_RED` ± `RED_SWING` of the view: 20 to 35 % with a margin."""

Image = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Episode:
    """Robot number `robot` sees red from `start` to `end` [s from the start of the run]."""

    robot: int
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Frame:
    """One rendered frame; `red` is the fraction of its pixels that the red object covers."""

    jpeg: bytes
    red: float


def schedule(seed: int, robots: int, seconds: float) -> tuple[Episode, ...]:
    """Who sees red when: one robot at a time for 3 to 6 s, with gaps of 1 to 2.5 s between."""
    rng = np.random.default_rng((seed, 1))
    episodes: list[Episode] = []
    time = float(rng.uniform(1.0, 1.5))
    while time < seconds:
        others = [robot for robot in range(robots) if robots == 1 or not episodes or robot != episodes[-1].robot]
        length = float(rng.uniform(3.0, 6.0))
        episodes.append(Episode(int(rng.choice(others)), time, time + length))
        time += length + float(rng.uniform(1.0, 2.5))
    return tuple(episodes)


def phases(seed: int, robots: int) -> tuple[float, ...]:
    """When within a period each robot's camera takes its frames [s]: spread, but not evenly."""
    jitter = np.random.default_rng((seed, 2)).uniform(-0.25, 0.25, robots)
    return tuple(float(PERIOD * ((robot + 0.5 + jitter[robot]) / robots)) for robot in range(robots))


class Scene:
    """What one robot sees. `frame` costs a few milliseconds."""

    def __init__(self, seed: int, robot: int, phase: float, episodes: Sequence[Episode]) -> None:
        rng = np.random.default_rng((seed, 3, robot))
        self._phase = phase
        self._episodes = [episode for episode in episodes if episode.robot == robot]
        self._world = _world(rng, WIDTH + 200, HEIGHT + 200)
        self._metal = _metal(rng)
        self._pan = rng.uniform(0.3, 0.8, 4)
        self._walkers = rng.uniform(0.0, 1.0, (5, 4))
        self._label = f"r{robot + 1}"

    def sees_red(self, number: int) -> bool:
        """Whether the red object is in the view of this frame."""
        return self._episode(number) is not None

    def frame(self, number: int) -> Frame:
        """Render frame `number`."""
        time = self._phase + number * PERIOD
        image = self._background(time)
        self._draw_walkers(image, time)
        episode = self._episode(number)
        red = 0.0 if episode is None else self._draw_object(image, time - episode.start)
        text = f"{self._label}  {time:6.1f} s"
        cv2.putText(image, text, (12, HEIGHT - 14), cv2.FONT_HERSHEY_SIMPLEX, 0.8, (0, 0, 0), 5, cv2.LINE_AA)
        cv2.putText(image, text, (12, HEIGHT - 14), cv2.FONT_HERSHEY_SIMPLEX, 0.8, (255, 255, 255), 2, cv2.LINE_AA)
        return Frame(_encode(image), red)

    def _episode(self, number: int) -> Episode | None:
        time = self._phase + number * PERIOD
        return next((e for e in self._episodes if e.start <= time < e.end), None)

    def _background(self, time: float) -> Image:
        """Cut out the part of the world that the robot, which never stands still, looks at."""
        p = self._pan
        x = int(100 + 60 * math.sin(p[0] * time) + 39 * math.sin(2.3 * p[1] * time))
        y = int(100 + 60 * math.cos(p[2] * time) + 39 * math.cos(1.7 * p[3] * time))
        return self._world[y : y + HEIGHT, x : x + WIDTH].copy()

    def _draw_walkers(self, image: Image, time: float) -> None:
        """Things that move: blue and green, never red."""
        for kind, (a, b, c, d) in enumerate(self._walkers):
            x = int(WIDTH * (0.5 + 0.45 * math.sin((0.4 + a) * time + 6 * b)))
            y = int(HEIGHT * (0.5 + 0.4 * math.cos((0.4 + c) * time + 6 * d)))
            color = ((200, 120, 30), (120, 180, 40), (220, 200, 120), (90, 140, 60), (180, 90, 60))[kind]
            cv2.circle(image, (x, y), 18 + 6 * kind, color, cv2.FILLED, cv2.LINE_AA)

    def _draw_object(self, image: Image, since: float) -> float:
        """Draw the red canister, `since` seconds after it came into view; return the fraction it covers."""
        fraction = BASE_RED + RED_SWING * math.sin(1.1 * since + self._phase * 50)
        # A body of w × 1.3 w and a round shoulder of half a w high (an ellipse's upper half).
        width = math.sqrt(fraction * WIDTH * HEIGHT / (1.05 + math.pi / 16))
        left = int(WIDTH / 2 - width / 2 + 80 * math.sin(0.9 * since))
        top = int((HEIGHT - 1.3 * width) / 2 + 10 * math.sin(2.1 * since))
        shoulder = int(top + 0.25 * width)
        mask = np.zeros((HEIGHT, WIDTH), np.uint8)
        right, bottom = int(left + width), int(shoulder + 1.05 * width)
        cv2.rectangle(mask, (left, shoulder), (right, bottom), 255, cv2.FILLED)
        center, axes = (int(left + width / 2), shoulder), (int(width / 2), int(width / 4))
        cv2.ellipse(mask, center, axes, 0, 180, 360, 255, cv2.FILLED)
        cv2.copyTo(self._metal, mask, image)
        return cv2.countNonZero(mask) / (WIDTH * HEIGHT)


def _world(rng: np.random.Generator, width: int, height: int) -> Image:
    """Return a surface in greys, blues and greens: octaves of noise, and a grain that JPEG must carry."""
    luma = np.full((height, width), 118.0, np.float32)
    for cell, amplitude in ((160, 60.0), (40, 30.0), (10, 18.0), (3, 10.0)):
        coarse = rng.uniform(-1, 1, (height // cell + 2, width // cell + 2)).astype(np.float32)
        luma += amplitude * cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC)
    luma += rng.normal(0, 5.0, luma.shape).astype(np.float32)
    tint = cv2.resize(rng.uniform(0, 1, (6, 7)).astype(np.float32), (width, height), interpolation=cv2.INTER_CUBIC)
    world = np.stack([luma * (1.0 + 0.25 * tint), luma * (1.2 - 0.2 * tint), luma * 0.85], axis=2)
    return np.asarray(np.clip(world, 0, 255), dtype=np.uint8)


def _metal(rng: np.random.Generator) -> Image:
    """Return a red surface, shaded from left to right, with a grain like the world's."""
    shade = 175 + 45 * np.sin(np.linspace(0, 4 * math.pi, WIDTH, dtype=np.float32))
    grain = cv2.resize(rng.normal(0, 1, (HEIGHT // 3, WIDTH // 3)).astype(np.float32), (WIDTH, HEIGHT))
    red = shade + 9 * grain + rng.normal(0, 5.0, (HEIGHT, WIDTH)).astype(np.float32)
    metal = np.stack([red * 0.13, red * 0.1, red], axis=2)
    return np.asarray(np.clip(metal, 0, 255), dtype=np.uint8)


def _encode(image: Image) -> bytes:
    """JPEG of between `SMALLEST` and `LARGEST` bytes."""
    for quality in QUALITIES:
        _, jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
        if SMALLEST <= len(jpeg) <= LARGEST:
            return jpeg.tobytes()
    raise ValueError(f"no JPEG quality gives a frame of {SMALLEST} to {LARGEST} bytes")
