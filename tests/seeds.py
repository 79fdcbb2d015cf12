"""Seeds for tests that hold for any: a few of them in `make test`, all in `make test-full`."""

import pytest


def seeds(count, few=5):
    """Return the values for `parametrize`: numbers below `count`, of which the first `few` are tried in `make test`."""
    return [pytest.param(seed, marks=() if seed < few else pytest.mark.full) for seed in range(count)]
