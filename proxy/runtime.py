"""What an operator may change while the daemon runs: its mode and its specs, one value that is swapped whole."""

import math
from dataclasses import dataclass, replace

from proxy.core.model.mode import Mode, in_force
from utility_specs import InformationType, Specs


@dataclass(frozen=True, slots=True)
class Runtime:
    """A mode with a generation of specs. Who asks it twice gets the same answer."""

    mode: Mode
    specs: Specs

    def mode_of(self, covering: InformationType) -> Mode:
        """Return the mode in which samples of a type are treated."""
        return in_force(self.mode, covering.mode)

    def drops(self, covering: InformationType | None) -> bool:
        """Whether some samples that a type covers may be dropped on purpose."""
        return covering is not None and not covering.bypass and self.mode_of(covering) is Mode.ENFORCE

    @property
    def pace(self) -> float | None:
        """The rate of the tightest limit of the channel [B/s]; None: samples go as fast as they can, as some must."""
        rate = min((constraint.measure.pace for constraint in self.specs.constraints), default=math.inf)
        paced = self.mode is Mode.ENFORCE and "shadow" not in self.specs.modes and math.isfinite(rate)
        return rate if paced else None

    @property
    def adaptive(self) -> bool:
        """Whether any limit follows the channel."""
        return any(constraint.least < 1.0 for constraint in self.specs.constraints)


class LiveRuntime:
    """The one home of the runtime in force. It changes on the loop's thread; any thread may read it."""

    def __init__(self, runtime: Runtime) -> None:
        self.runtime = runtime
        """Who asks it more than one thing takes it once."""

    def match(self, key: str) -> InformationType | None:
        """Return the type that covers `key`."""
        return self.runtime.specs.match(key)

    def counts_each(self, key: str) -> bool:
        """Whether each sample of `key` counts, not the newest alone."""
        covering = self.match(key)
        return covering is not None and not covering.markovian

    def drops_queries(self, key: str) -> bool:
        """Whether a spec drops the queries for `key`."""
        covering = self.match(key)
        return covering is not None and covering.queries == "drop"

    def switch(self, mode: Mode) -> None:
        """Put another mode in force."""
        self.runtime = replace(self.runtime, mode=mode)

    def swap(self, specs: Specs) -> None:
        """Put another generation of specs in force."""
        self.runtime = replace(self.runtime, specs=specs)
