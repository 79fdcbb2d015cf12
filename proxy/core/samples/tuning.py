"""The constants of this package, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SamplesTuning:
    """Constants of the gate, and of what is kept for robots that are away."""

    taken_up_at_once: int = 128
    """Samples taken up at one event at most: what else happens has its turn before the rest of a burst."""
    patience: float = 3.0
    """A sample gives way for this many times as long as it waits for room, then it is dropped (1.0: 93.8 %, not
    95.2)."""
    shortest_wait: float = 1e-3
    """A sample gives way for at least this long [s]."""
    answered_within: float = 0.1
    """What is told waits for an answer so long at most, to tell of it, too [s]."""
    fewest_iterations: int = 50
    """Iterations of a search, however many samples wait."""
    samples_per_halving: int = 4
    """With as many samples waiting a search has half the iterations, with twice as many a third."""
    proven_gap: float = 1e-9
    """A plan is the best one if its utility may be exceeded by no more than this part of it."""
    warnings_apart: float = 60.0
    """The log repeats that samples were dropped for the same reason after this long [s]."""
    doubtful: float = 14.0
    """What was sent this shortly before a loss may not have arrived [s]: Zenoh's lease of 10 s, and buffers of 3.8."""
    retry: float = 0.25
    """A copy that a plan was against is decided again after this long [s]."""
    room_checked_every: float = 0.05
    """Copies are tried again this often while there is no room for them [s]."""
    robots: int = 64
    """Robots that copies are kept for; of more, the one that left first is gone."""
    copies: int = 8192
    """Copies in all."""
    payload_bytes: int = 16 * 1024 * 1024
    """Bytes of the payloads that the driver keeps, each counted once [B]."""
    reminder_every: float = 1.0
    """A robot that is back is reminded this often that copies still wait for it [s]."""
    named_keys: int = 64
    """A robot that is back is told the names of at most this many keys of which copies wait."""
    entries: int = 16
    """Entries of a stream in the log of decisions, which takes 5 MB at most: 2.4 with 500 cameras."""
    logged_streams: int = 512
    """Streams in the log of decisions."""
    logged_searches: int = 512
    """Decisions by searches in that log, of all streams: each takes some 4 kB, and 60 μs to be noted, of 4 ms."""
    rivals: int = 8
    """Streams that competed with a sample that the log names at most."""


TUNING = SamplesTuning()
