"""What states, questions and answers may take: they go out when they must, and are paid for in time."""

from proxy.core.gossip.tuning import TUNING


class StateBudget:
    """Our part of the allowance for all that is no digest."""

    def __init__(self, rate: float) -> None:
        self._allowance, self._robots = rate, 1
        self._debt = -TUNING.state_savings * rate
        """What is not paid for yet; negative: what is saved [B]."""

    def set_rate(self, allowance: float, robots: int) -> None:
        """The allowance of so many robots is now this [B/s]."""
        self._allowance, self._robots = allowance, robots

    def gain(self, seconds: float) -> None:
        """So much time went by."""
        self._debt = max(self._debt - seconds * self._rate, -TUNING.state_savings * self._rate)

    def owe(self, size: int, copies: int) -> None:
        """Something of so many bytes went out in so many copies."""
        self._debt += (size + TUNING.overhead) * copies

    @property
    def paid_in(self) -> float:
        """How long it takes from the last gain on until all is paid for [s]."""
        return max(0.0, self._debt) / self._rate

    def takes(self, size: int, copies: int) -> float:
        """Return for how long a state of so many bytes, in so many copies, takes what we may spend on states [s]."""
        return (size + TUNING.overhead) * copies / self._rate

    def question_takes(self) -> float:
        """Return for how long a question and its answer take the allowance, where all robots ask in turn [s]."""
        return (TUNING.question + TUNING.answer) * self._robots / self._allowance

    @property
    def _rate(self) -> float:
        return TUNING.states * self._allowance / self._robots
