"""The traffic of a team, made up: what each robot sends, and on which keys."""

import json
import random
from collections.abc import Iterable, Iterator

import cv2
import msgpack
import numpy as np

from proxy.core.forecast.schedule import Schedule
from utility_specs.learning.observed import Observed
from utility_specs.learning.stream import Stream

SECONDS = 20


def regular(key: str, rate: float, payload, seconds: float = SECONDS, begin: float = 0.0, **said) -> list[Observed]:
    """Samples at a rate [Hz]; `payload(i)` makes the bytes of sample number `i`."""
    return [Observed(begin + i / rate, key, payload(i), **said) for i in range(round(seconds * rate))]


def at_random(key: str, interval: float, payload, seed: int, seconds: float = SECONDS) -> Iterator[Observed]:
    """Samples at random moments, a mean interval apart [s]."""
    rng = random.Random(seed)
    t = rng.expovariate(1 / interval)
    while t < seconds:
        yield Observed(t, key, payload(rng))
        t += rng.expovariate(1 / interval)


def stream_of(samples: Iterable[Observed]) -> Stream:
    """One stream of all samples."""
    stream = None
    for sample in samples:
        stream = stream or Stream(sample.key, Schedule())
        stream.take(sample)
    return stream


def streams_of(*all_samples: Iterable[Observed]) -> list[Stream]:
    return [stream_of(samples) for samples in all_samples]


def json_bytes(**document) -> bytes:
    return json.dumps(document).encode()


def picture(red: float, side: int = 64) -> bytes:
    """A JPEG of which a part is red."""
    image = np.full((side, side, 3), 120, np.uint8)
    image[:, : round(red * side)] = (0, 0, 230)
    return cv2.imencode(".jpg", image)[1].tobytes()


STATES = ("ok", "low")
PICTURES = [picture(red) for red in (0.0, 0.0, 0.25, 0.5)]


def robot(name: str, seed: int) -> list[Observed]:
    """What one robot sends: images, its pose, its battery, a map once, and alarms now and then."""
    rng = random.Random(seed)
    x = np.cumsum([rng.gauss(0.1, 0.02) for _ in range(10 * SECONDS)]).tolist()
    begin = 0.1 * seed
    return [
        *regular(f"robot/{name}/camera", 5.0, lambda i: PICTURES[i // 20 % 4], begin=begin, encoding="image/jpeg"),
        *regular(f"robot/{name}/pose", 10.0, lambda i: msgpack.packb({"x": x[i], "yaw": rng.gauss(0, 1)}), begin=begin),
        *regular(
            f"robot/{name}/battery",
            1.0,
            lambda i: json_bytes(charge=0.9 - 0.01 * i, seq=i, stamp=1.7e9 + i, model="A", state=STATES[i > 17]),
            begin=begin,
        ),
        Observed(3.0 + begin, f"robot/{name}/map", b"\xff" * 20_000),
        *at_random(f"robot/{name}/alarm", 1.4, lambda rng: json_bytes(severity=rng.randint(1, 5)), seed),
    ]


def team(*names: str) -> list[Observed]:
    """What all robots send, in the order of time."""
    samples = [sample for seed, name in enumerate(names, 1) for sample in robot(name, seed)]
    return sorted(samples, key=lambda sample: sample.time)
