"""The constants of the daemon's threads, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DaemonTuning:
    """How much may wait, how long is waited, and how often it is looked; packages below have constants of their own."""

    # Starting and stopping
    niceness: int = -10
    """The niceness of the daemon where it may choose: ten times the weight of a usual process."""
    slice: float = 0.004
    """How long it is not interrupted then, where the kernel can be asked for that [s]: a decision takes 3 ms. What
    took so long beside three busy processes on two cores was done after 3.2 to 5.6 ms at the median, and after 6.1 to 8
    with the kernel's own 1.4 ms."""
    stop_time: float = 0.7
    """A stop may take this long [s]."""
    stop_wait: float = 0.15
    """Of which each thread is waited for this long, as it may be inside a call of Zenoh [s]."""
    farewell: float = 0.15
    """The routers of the app side have this long to take note of each other's end [s]."""

    # Memory
    spare: int = 16 * 1024 * 1024
    """So much more than is usual is left where it was freed [B]."""
    spare_looks: float = 30.0
    """Time between two looks at that [s]: what comes more often needs it again."""

    # Samples on their way to the core
    items: int = 8192
    """Items that may wait for the core; more are taken in only if they must not be lost."""
    between: int = 4
    """So many of them are taken between two things that follow from what was done last."""
    noted: float = 0.4
    """What the core only notes it learns this late at most [s]. With 0.05 an idle daemon among ten others woke for each
    digest, which took a third of its processor time."""
    noted_at_once: int = 64
    """So many such items it learns at once: together they take some milliseconds."""
    after_fault: float = 0.1
    """After an event that the core could not handle time passes so much later [s]."""
    uptake_interval: float = 0.002
    """The core takes up samples of one Markovian stream at least this far apart [s]."""
    uptakes_ahead: float = 0.004
    """Where they only have to be sent on, it takes them up so much ahead of that [s]: of 200 samples a second with a
    jitter of 2 ms each seventh comes less than 2 ms after the one before, and would wake the loop."""
    uptakes: int = 4096
    """Keys of which it is remembered when the core took up a sample."""
    none_gives_way: int = 64
    """So many samples of a key that all go may wait for the core before newer ones take their places."""
    extracted_at_once: float = 0.005
    """Features that take no longer are extracted by the thread that brings the sample [s]: another one took 0.1 ms to
    wake on a machine with time, and 3 to 5 ms in each fourth case where two cores were busy."""
    costly_jobs: int = 8
    """Samples whose costly features may wait to be extracted; each is held meanwhile."""
    hangs_after: float = 2.0
    """A feature that takes longer may never come to its end [s]."""

    # Decisions
    iterations: int = 25
    """Iterations between two looks at the clock, at most: in large windows they take long, so it begins with fewer."""
    decided_at_once: float = 0.002
    """A search that lasts longer, as few do, goes on on a thread of its own [s]."""
    search_part: float = 0.8
    """A search ends after this part of the deadline: the rest is for the plan, and for the way back to the core."""
    stuck_after: float = 2.0
    """A decision that takes this much longer than it may will never end [s]."""

    # Other robots, and operators
    away: float = 600.0
    """A robot that has vanished for longer is gone: nothing is kept for it any more [s]."""
    orders: int = 16
    """Orders that may wait, each of which may be of megabytes."""
    streams_told: int = 16
    """Streams of which `sendworthy why` tells decisions at once; the others are named."""
    decisions_told: int = 64
    """Decisions on all of them together: making words of one takes the loop about 0.1 ms."""
    core_wait: float = 2.0
    """Whoever reloads, orders, or asks the core something from another thread waits for it for this long [s]."""
    pushed_files: int = 64
    """Spec files that may be pushed at once."""
    pushed_bytes: int = 1024 * 1024
    """Bytes of all these files together [B]."""

    # The wall clock
    wall_clock_interval: float = 1.0
    """Time between two looks at what the wall clock shows [s]."""
    wall_clock_step: float = 1e-3
    """Less than this is no step of the wall clock [s]."""
    wall_clock_calm: float = 600.0
    """A wall clock is known better than it was when it has been for so long [s]."""
    wall_clock_readings: int = 5
    """It is read so many times at once; the reading that took the shortest time counts."""


TUNING = DaemonTuning()
