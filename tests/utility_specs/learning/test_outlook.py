"""Which method forecasts best."""

import random

import pytest

from utility_specs.learning.candidates import Candidate
from utility_specs.learning.outlook import best_method


def candidate(*values):
    return Candidate("x", "", ([(float(t), value) for t, value in enumerate(values)],))


def test_each_method_has_its_signals():
    """A walk stays where it is, noise returns to its mean, what rises goes on rising."""
    rng = random.Random(1)
    noise = [rng.gauss(0, 1) for _ in range(100)]
    walk = [sum(noise[:i]) for i in range(100)]
    assert best_method([candidate(*walk)]) == ("last", 0.0)
    name, less = best_method([candidate(*noise)])
    assert (name, 0.1 < less < 0.5) == ("mean", True)
    name, less = best_method([candidate(*(0.5 * i for i in range(100)))])
    assert (name, less) == ("trend", pytest.approx(0.99, abs=0.02))


@pytest.mark.parametrize("candidates", [[], [candidate(1.0, 2.0, 3.0)], [candidate(*[1.0] * 50)]])
def test_without_evidence_the_last_value_holds(candidates):
    """Of a few values, or where nothing changes, no method is better."""
    assert best_method(candidates) == ("last", 0.0)


def test_features_count_alike_whatever_their_size():
    """The errors of each are told in its own deviations."""
    rng = random.Random(1)
    noise = candidate(*(rng.gauss(0, 1) for _ in range(60)))
    methods = {best_method([noise, candidate(*(size * t for t in range(60)))]) for size in (1e-6, 1.0, 1e6)}
    assert len({(name, round(less, 6)) for name, less in methods}) == 1
