"""A utility in Python, as specs name it."""

import numpy as np


def fading(ages, features):
    """Worth more, the more red is seen."""
    return np.exp(-ages) * (1.0 + features["red"])
