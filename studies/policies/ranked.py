"""The room that constraints leave, given to messages by their rank."""

from collections.abc import Mapping

from planner import Problem
from planner.constraints import violations


def fits_by_rank(window: Problem, worth: Mapping[int, float]) -> bool:
    """Whether the current message finds room after all of greater worth, by index in the window, that find it."""
    placed: list[int] = []
    for index in sorted(worth, key=worth.__getitem__, reverse=True):
        if not violations(window, [*placed, index]):
            placed.append(index)
            if index == window.current:
                return True
    return False


def share(window: Problem, index: int) -> float:
    """Return the greatest share of a limit that a message uses; a little for one that uses none."""
    limits = [constraint.limit for constraint in window.constraints]
    shares = [use / limit for use, limit in zip(window.messages[index].use, limits, strict=True) if limit > 0]
    return max(shares, default=0.0) or 1e-9
