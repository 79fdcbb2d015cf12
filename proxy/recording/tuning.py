"""The constants of recording, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RecordingTuning:
    """How much waits, how much is written at once, and how large a file of others may claim to be."""

    events: int = 8192
    """Events that may wait to be written; more are missing: two seconds of what a daemon can take in."""
    payload_bytes: int = 4 * 1024 * 1024
    """Bytes of payloads that may wait [B]: they are held in memory meanwhile."""
    slice: int = 256
    """Events that are written in one go: the loop waits for Python's lock meanwhile, for half a millisecond."""
    pause: float = 50e-6
    """Between two slices the lock is free for so long at least [s]: a thread needs 20 to 50 us to wake."""
    flush: float = 2.0
    """What waits is written this often [s]: so much is lost when the daemon is killed. To wake, and to write a chunk,
    takes a third of a millisecond, however few events are in it."""
    many: int = 1024
    """So many events are not left waiting until then: at 300 B each."""
    young: int = 10_000
    """So many objects are made until Python looks for garbage among them, as what waits is none: with its own 700
    it looked two to three times a second, for 0.5 to 1.5 % of what a daemon takes that has 200 samples a second."""
    retry: float = 1.0
    """Where nothing can be written it is tried again after this time [s], then after twice that, and so on..."""
    longest_retry: float = 60.0
    """... up to this [s]: where there is room for a word but for nothing else each try is in vain."""
    patience: float = 1.5
    """Whoever has a recording stopped waits for its end so long at most [s]: less than he waits for an answer."""
    chunk: int = 256 * 1024
    """Bytes of messages that are compressed together: more compress hardly better, and are held in memory."""
    reserve: int = 512 * 1024
    """A file is full when it lacks so much of what it may take [B]: two chunks, for that is seen once one is written,
    and what is in hand then, up to where the core can be asked for what it knows, still goes there."""
    step: float = 1.0
    """Another file begins where the wall clock was set by more [s]: what corrects a clock that runs is less."""
    channels: int = 50_000
    """A file with so many keys of payloads is full: MCAP numbers 65,535, and events that wait may be of others."""
    snapshot: int = 32 * 1024 * 1024
    """Largest snapshot of the core [B]: one of 500 streams takes 1.2 MB, one of 4,096 about 10."""
    record: int = 64 * 1024 * 1024
    """Largest record that is read [B], packed or not: a damaged length must not take the memory."""
    line: int = 16 * 1024 * 1024
    """Largest JSON message that is read [B]: a state of 4,096 streams takes less than 1 MB."""


TUNING = RecordingTuning()
