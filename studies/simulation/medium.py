"""A shared medium: one queue, one rate, a fixed way through the air, and a chance of loss."""

from dataclasses import dataclass

import numpy as np


@dataclass(slots=True)
class Medium:
    """Serves what is offered in order of arrival. `rate` is in B/s, `delay` in seconds, `loss` a probability."""

    rate: float
    delay: float = 0.002
    loss: float = 0.0
    busy_until: float = 0.0
    carried: int = 0

    def offer(self, now: float, size: int, rng: np.random.Generator) -> float | None:
        """Put `size` bytes on the air at `now`; return when they have arrived, None when they are lost."""
        self.busy_until = max(now, self.busy_until) + size / self.rate
        self.carried += size
        if self.loss and rng.random() < self.loss:
            return None
        return self.busy_until + self.delay
