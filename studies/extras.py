"""What the commands of the studies need beyond Sendworthy itself, and how to install it."""

from importlib.util import find_spec

PACKAGES = {"mcap": "record", "scipy": "study", "matplotlib": "study", "rosbags": "ros2"}
"""Packages by the extra that has them."""


def missing(*packages: str) -> str | None:
    """Return what to install for some packages; None where all are there."""
    lacking = [package for package in packages if find_spec(package) is None]
    if not lacking:
        return None
    extras = ",".join(dict.fromkeys(PACKAGES[package] for package in lacking))
    are = "is" if len(lacking) == 1 else "are"
    return f"{' and '.join(lacking)} {are} not installed: pip install 'sendworthy[{extras}]'"
