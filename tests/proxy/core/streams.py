"""Seeded generation times of streams, and how far forecasts of them are off."""

import numpy as np

from proxy.core.forecast.schedule import Schedule


def periodic(count, period=1.0, jitter=0.0, seed=0, start=5.0):
    """Generation times on a grid; `jitter` is a part of the period."""
    times = start + period * (np.arange(count) + np.random.default_rng(seed).normal(0.0, jitter, count))
    return np.sort(times).tolist()


def poisson(count, interval=1.0, seed=0):
    return np.cumsum(np.random.default_rng(seed).exponential(interval, count)).tolist()


def bursts(count, *, size=5, step=0.05, spacing=2.0, jitter=0.0):
    offs = np.random.default_rng(count).normal(0.0, jitter, count)
    return [float(b * spacing + off + i * step) for b, off in enumerate(offs) for i in range(size)]


def observe(schedule, times, *, loss=0.0, seed=0, first=1):
    """Let a schedule see the times, less those that are lost."""
    rng = np.random.default_rng(seed)
    for number, t in enumerate(times, first):
        if rng.random() >= loss:
            schedule.observe(number, t)
    return schedule


def errors(times, *, loss, seed=0, skip=12, ahead=3, schedule=None):
    """How far off the next `ahead` times are that are forecast 0.3 s after each sample seen [s]; inf for none."""
    rng = np.random.default_rng(seed + 1000)
    schedule = schedule or Schedule()
    found = []
    for at, t in enumerate(times[:-ahead]):
        if rng.random() < loss:
            continue
        schedule.observe(at + 1, t)
        if at >= skip:
            forecast = schedule.forecast(t + 0.3, t + 100.0, ahead)
            found += [abs(a - b) for a, b in zip(forecast, times[at + 1 :], strict=False)]
            found += [np.inf] * (ahead - len(forecast))
    return np.array(found)
