"""Which payloads the driver keeps: each from `Keep` until `Forget`, as long as any part of the core may need it."""

from collections import Counter

from proxy.core.interface.commands import Command, Forget, Keep
from proxy.core.model.waiting import Waiting


class HeldPayloads:
    """Counts who needs the payload of a sample."""

    def __init__(self) -> None:
        self.bytes = 0
        """What all payloads take that are kept [B]."""
        self._holders: Counter[int] = Counter()
        self._sizes: dict[int, int] = {}
        self._new: set[int] = set()
        self._freed: set[int] = set()
        """Samples that the driver is to keep from now on, and those that it may forget."""

    def hold(self, waiting: Waiting) -> None:
        """One more needs the payload of a sample."""
        sample = waiting.sample
        self._holders[sample] += 1
        if self._holders[sample] == 1:
            self._sizes[sample] = waiting.size
            self.bytes += waiting.size
            (self._freed.discard if sample in self._freed else self._new.add)(sample)

    def release(self, sample: int) -> None:
        """One less needs the payload of a sample."""
        self._holders[sample] -= 1
        if not self._holders[sample]:
            del self._holders[sample]
            self.bytes -= self._sizes.pop(sample)
            (self._new.discard if sample in self._new else self._freed.add)(sample)

    def around(self, commands: list[Command]) -> list[Command]:
        """Return commands with what the driver has to keep before them, and what it may forget after them."""
        if not (self._new or self._freed):
            return commands
        keep, forget = map(Keep, sorted(self._new)), map(Forget, sorted(self._freed))
        self._new, self._freed = set(), set()
        return [*keep, *commands, *forget]
