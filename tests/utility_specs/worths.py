"""Functions that specs of the tests name."""

import numpy as np


def by_red(age, features):
    """Worth as much as there is red; fails where that is below 0."""
    return features["red"] * np.exp(-age)


def by_blue(age, features):
    """Ask for a feature that no spec has."""
    return features["blue"] * age


def two_lines(_age, _features):
    """Complain at length."""
    raise RuntimeError("one\ntwo")


def by_number(age, features):
    """Cameras with higher numbers matter for longer."""
    return np.exp(-age / features["n"])
