"""The constants of recording, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RecordingTuning:
    """How much waits, how much is written at once, and how large a file of others may claim to be."""

    chunk: int = 256 * 1024
    """Bytes of messages that are compressed together: more compress hardly better, and are held in memory."""
    record: int = 64 * 1024 * 1024
    """Largest record that is read [B], packed or not: a damaged length must not take the memory."""
    line: int = 16 * 1024 * 1024
    """Largest JSON message that is read [B]: a state of 4,096 streams takes less than 1 MB."""


TUNING = RecordingTuning()
