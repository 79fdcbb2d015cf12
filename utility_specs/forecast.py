"""What the features of a stream's next message will be, as far as its past tells (§4.3)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Observed:
    """The features of one past message, generated at `t_gen` [s]."""

    t_gen: float
    features: Mapping[str, float]


class FeatureForecast(Protocol):
    """Predicts features from those of the same stream's past messages."""

    @property
    def kind(self) -> str:
        """The name of the method, as specs write it."""

    def predict(self, history: Sequence[Observed], t_gen: float) -> Mapping[str, float]:
        """Return the features of a message to be generated at `t_gen` [s]; `history` has the oldest first.

        Features that cannot be told are left out; then their defaults hold.
        """


@dataclass(frozen=True, slots=True)
class LastForecast:
    """The next message resembles the last one: simple, and right surprisingly often."""

    @property
    def kind(self) -> str:
        """`last`."""
        return "last"

    def predict(self, history: Sequence[Observed], t_gen: float) -> Mapping[str, float]:  # noqa: ARG002 - whenever it is
        """Return the features of the last message; nothing when there is none."""
        return history[-1].features if history else {}
