"""Random message utilities of every kind, and their integrals by quadrature."""

import itertools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scipy.integrate import quad

from planner import Custom, Exponential, Linear, MessageUtility, Polynomial, Power, Step, Table, Video
from planner.utility import Floats

worths, times = st.floats(0, 100), st.floats(1e-2, 100)
ages = st.floats(0, 50)
spans = st.tuples(ages, ages).map(sorted)


def decay(age: Floats, features: dict[str, float]) -> Floats:
    """A utility that a user might write."""
    return features["worth"] * np.exp(-age / features["tau"]) + features.get("rest", 0.0)


def points(first: float, gaps: list[float], values: list[float]) -> Table:
    """A table whose ages are so far apart."""
    return Table(tuple(zip(itertools.accumulate(gaps, initial=first), values, strict=False)))


falling = {
    Linear: st.builds(Linear, worths, st.floats(1e-3, 100)),
    Video: st.builds(Video, st.floats(1e-3, 1), st.floats(1.1, 100)),
    Exponential: st.builds(Exponential, worths, times),
    Step: st.builds(Step, worths, times),
    Polynomial: st.builds(Polynomial, worths, times, st.floats(0.1, 10)),
    Power: st.builds(Power, st.floats(0.01, 0.9)),
    Custom: st.builds(Custom, st.just(decay), st.fixed_dictionaries({"worth": worths, "tau": times}), times),
}
kinds = falling | {
    Table: st.integers(1, 6).flatmap(
        lambda size: st.builds(
            points,
            st.just(0.0) | times,
            st.lists(st.floats(1e-2, 20), min_size=size, max_size=size),
            st.lists(worths, min_size=size, max_size=size),
        )
    )
}
utilities = st.one_of(*kinds.values())
alike = st.one_of([st.lists(kind, min_size=1, max_size=5) for kind in kinds.values()])


def by_quadrature(utility: MessageUtility, start: float, end: float) -> float:
    """∫ of `value` over [start, end], piece by piece between its corners."""
    edges = np.array([start, *sorted(age for age in _corners(utility) if start < age < end), end])
    if isinstance(utility, Table | Custom):  # straight lines
        return float(np.trapezoid(utility.value(edges), edges))
    if isinstance(utility, Power):  # a = exp(y) takes the singularity away
        edges = np.log(np.maximum(edges, 1e-300))
        return sum(quad(lambda y: _value(utility, np.exp(y)) * np.exp(y), a, b)[0] for a, b in _pieces(edges))
    return sum(quad(lambda age: _value(utility, age), a, b)[0] for a, b in itertools.pairwise(edges))


def _value(utility: MessageUtility, age: float) -> float:
    return float(utility.value(np.array([age]))[0])


def _pieces(edges: Floats) -> itertools.pairwise:
    """Cut a long way into pieces that quadrature finds its way in."""
    return itertools.pairwise(np.linspace(edges[0], edges[-1], 50))


def _corners(utility: MessageUtility) -> Iterable[float]:
    """Ages at which quadrature would stumble."""
    of: dict[type, Callable[[Any], Iterable[float]]] = {
        Linear: lambda linear: [linear.u0 / linear.slope],
        Video: lambda video: [video.a0, video.a1],
        Exponential: lambda exponential: exponential.tau * np.array([0.1, 1, 3, 10, 30]),
        Step: lambda step: [step.lifetime],
        Polynomial: lambda polynomial: [polynomial.a1 / 1000, polynomial.a1],
        Power: lambda _: [],
        Table: lambda table: [age for age, _ in table.points],
        Custom: lambda custom: custom.curve.ages,
    }
    return of[type(utility)](utility)
