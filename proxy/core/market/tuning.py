"""The constants of the market."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MarketTuning:
    """Each with what it is for, and the measurement behind it where there is one."""

    interval: float = 0.2
    """Streams are weighed anew this often [s], before a sample is decided, or ahead where samples come more often..."""
    interval_each: float = 1e-3
    """... where many streams compete only after so long for each of them [s]."""
    known: float = 1.0
    """Who only looks is told the prices by which was decided last, if they are no older [s]: anew took 2.5 of 4 ms."""

    small: float = 0.05
    """A message is small that takes no more than this part of every limit: fifths, booked, reached 92.5 %, not 99.4."""
    smallest: float = 0.02
    """Where a plan can hold all messages that take more than this, only what takes no more is small: ten robots, twenty
    messages to a window, reach 97.9 % of the bound so instead of 95.4. With too many the price does better (97 %
    instead of 94)."""
    new_price: float = 4.0
    """The samples of a new stream are undisputed only if they earn so many times their price: nobody knows its rate."""
    offered: float = 0.95
    """What varies needs the rest of a limit: 250 small streams reached 99.4 % of the bound so, without it 99.3."""
    offered_deviations: float = 2.0
    """And for so many standard deviations of what is sent in a window: else the last of many small samples took the
    room of contested ones worth much (twelve robots: 67 % of the bound, and 91 now; with one deviation 84)..."""
    long_window: float = 5.0
    """In longer windows [s] what was sent counts when room is given away..."""
    long_ahead: tuple[float, ...] = (0.05, 0.1, 0.25)
    """... for these parts of a window ahead: no more than is left then, so that nobody is silent until it passed."""
    least_offered: float = 0.5
    """... but this part of a limit is offered whatever varies."""
    varying_size: float = 0.2
    """Of messages larger than this part of a limit the tree says which go: else four robots sent 63 % of small ones."""
    longest_departure: float = 0.02
    """Large samples take to leave at most so long after they were decided [s]."""
    few_others: int = 5
    """Where no more others speak, what left late counts once: of eight robots with cameras, and an operator, 1.2 % of
    the windows were over the limit so, and 0.02 are where it counts twice (four robots: 0.2 either way)."""
    cheaper: tuple[float, ...] = (0.0, 0.1, 0.2, 0.4, 0.7)
    """Room that whole messages leave over costs the first of these parts of its price for which it is enough."""
    needless: float = 1e-6
    """Of a stream that earns less by no more than this part where it sends less often not every sample is needed."""
    hopeless: float = 0.3
    """A stream is hopeless when its first sample earns no more than this part of the price."""
    reserve_deviations: float = 2.0
    """The reserve is so many standard deviations above the mean: with three, four robots with cameras sent 4 % fewer
    bytes; with one eight had three times as many windows over."""
    sure_deviations: float = 3.0
    """There is room for all where there is with so many standard deviations."""
    least_variance: float = 0.25
    """In both the count of a periodic stream in a window varies by at least this: by one or none."""
    rhythm_samples: int = 3
    """Of a stream that generated fewer samples nobody knows how far apart they are."""
    new_samples: float = 2.5
    """A new stream goes on as with half a sample less; if it is the only new one so many more."""
    rate_samples: int = 8
    """Of a stream that generated fewer samples nobody can say how often it does."""
    rate_time: float = 2.5
    """... nor before so long [s], or a window where that is shorter: in one of 30 s three robots with cameras sent all
    there was for 5 s, and from 18 s on nothing for 12, alarms included."""
    untold: float = 2.0
    """News of a stream of which few samples are known are late after so many of its intervals (`presumed.py`)."""
    bids: int = 300
    """What robots of which little is known are taken to bid with are so many streams at most: 10,000 took 67 ms."""
    longest: float = 300.0
    """What a stream loses by what it shows too much counts up to so many of its intervals: none sends more seldom."""
    most_scale: float = 1e100
    """What is worth more counts as this, so that all sums are finite."""

    booked: float = 0.9
    """No more than this part of a limit is booked, nor what the largest contested messages need..."""
    smaller_deviations: float = 0.7
    """... of which those are sent that are so many deviations smaller than the mean: with frames of 60 kB two robots
    had 2.8 % of the windows over the limit where it was the mean, and 0.04 so."""
    patience: float = 0.75
    """A sample waits for room for this part of its stream's period (95.5 % of the bound, not 94.2), or a window."""
    late_period: float = 0.15
    """A contested sample may be late by this part of the shortest period: every fifth frame fills 82 %, not 73..."""
    late_window: float = 0.05
    """... but not by more than this part of a window..."""
    late_robots: int = 2
    """... nor where more robots compete, for what they wait for is not known: two sent 3 % more, four 2 % less."""
    paced: float = 0.8
    """A sample keeps the channel busy for at most this part of what it takes at the limits' pace (all: 79 % filled, not
    82)..."""
    paced_least: float = 0.25
    """... and for less than this part nobody waits: a channel so fast gains nothing (1.1 % over, not 0.4)..."""
    paced_ahead: float = 4.0
    """... and plans' windows are shorter by so many samples, as bursts go one by one (82 % filled without, now
    91)..."""
    paced_window: float = 0.2
    """... but not by more than this part of a window."""
    alike: float = 0.1
    """A sample whose worth differs by more than this part from what was weighed is decided on its own."""

    undersubscribed: float = 0.7
    """A limit is undersubscribed while all need no more than this part of it..."""
    undersubscribed_new: float = 0.05
    """... and, while any of them is new, no more than this part: else each of many new streams has a search."""
    ample: float = 2.0
    """There is ample room where so many times as much would fit: then it is not looked at after each sample."""
    many_waiting: int = 8
    """With more samples waiting than this there is no time for searches that are not needed."""
    closed: float = 1e-6
    """Windows are closed: what was sent a whole window ago still counts for this moment [s]."""


TUNING = MarketTuning()
