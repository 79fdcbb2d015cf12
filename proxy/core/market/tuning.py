"""The constants of the market."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MarketTuning:
    """Each with what it is for, and the measurement behind it where there is one."""

    interval: float = 0.2
    """Streams are weighed anew this often [s], before a sample is decided, or when it is time to where samples come
    more often: they need not wait for it, which takes as long as search and window..."""
    interval_each: float = 1e-3
    """... where many streams compete only after so long for each of them [s]."""
    known: float = 1.0
    """Who only looks is told the prices by which was decided last, if they are no older than this [s]: to work them out
    anew took 2.5 ms of the 4 ms of a status with 200 streams."""

    small: float = 0.05
    """A message is small that takes no more than this part of every limit. With streams of equal messages, five to a
    window, booked as load teams reached 92.5 % of the bound instead of 99.4: room was kept for whole messages."""
    smallest: float = 0.02
    """Where a plan can hold all messages that take more than this, only what takes no more is small: ten robots with
    equal messages, twenty to a window, reached 95.4 % of the bound where the price alone decided, and reach 97.9. Where
    there are too many for one plan the price does better: eight robots with five streams of 0.1 to 4 kB each that
    broadcast reached 94 % of a central decider where plans decided on what takes more than 3 %, and reach 97."""
    new_price: float = 4.0
    """The samples of a new stream are undisputed only if they earn so many times their price: nobody knows its rate."""
    offered: float = 0.95
    """What varies needs the rest of a limit: so 250 small streams reached 99.4 % of the bound, without a rest 99.3, and
    their decisions took a sixth more time."""
    offered_deviations: float = 2.0
    """And for so many standard deviations of what is sent in a window: where the price was as if all windows were alike
    the last of many small samples, worth little, took the room of contested ones worth much. Twelve robots with five
    streams of 0.1 to 4 kB each that broadcast reached 67 % of the bound on a channel that refuses what exceeds it, and
    reach 91; with one deviation 84..."""
    least_offered: float = 0.5
    """... but this part of a limit is offered whatever varies."""
    varying_size: float = 0.2
    """Of messages that are larger than this part of a limit the tree says which go together: where they counted as
    varying, too, four robots with cameras sent 63 % of their small samples."""
    hopeless: float = 0.3
    """A stream is hopeless when its first sample earns no more than this part of the price."""
    reserve_deviations: float = 2.0
    """The reserve is so many standard deviations above the mean: with three, four robots with cameras sent 4 % fewer
    bytes; with one, 2 % more, and three times as many windows of eight robots were over the limit."""
    sure_deviations: float = 3.0
    """There is room for all where there is with so many standard deviations."""
    least_variance: float = 0.25
    """In both the count of a periodic stream in a window varies by at least this: by one or none."""
    rhythm_samples: int = 3
    """Of a stream that generated fewer samples nobody knows how far apart they are."""
    new_samples: float = 2.5
    """A new stream goes on as if it had generated half a sample less, for the first one only says when it began; but if
    it is the only new one so many more, as nobody knows better."""
    rate_samples: int = 8
    """Of a stream that generated fewer samples nobody can say how often it does."""
    longest: float = 300.0
    """What a stream loses by what it shows too much counts up to so many of its intervals: none sends more seldom."""
    most_scale: float = 1e100
    """What is worth more counts as this, so that all sums are finite."""

    booked: float = 0.9
    """No more than this part of a limit is booked, nor what the largest contested messages need..."""
    smaller_deviations: float = 0.7
    """... of which those are sent that are so many deviations smaller than the mean: with frames of 60 kB that nearly
    fill the limit, two robots exceeded it in 2.8 % of the windows and lost 1 % of the small samples where it was the
    mean, and in 0.04 % now."""
    patience: float = 0.75
    """A sample waits for room for this part of its stream's period: with random sizes and times 95.5 % of the bound
    instead of 94.2; where each sample counts for the longest window."""
    late_period: float = 0.15
    """A contested sample may be late by this part of the shortest period: a camera that sends every fifth frame needs
    windows that are a little shorter than five periods (82 % of the limit instead of 73)..."""
    late_window: float = 0.05
    """... but not by more than this part of a window..."""
    late_robots: int = 2
    """... nor where more robots compete, for what they wait for is not known: two sent 3 % more, four 2 % less."""
    paced: float = 0.8
    """A sample keeps the channel busy for no more than this part of what it takes at the pace of the limits: with all
    of it eight robots with cameras filled 79 % of the limit instead of 82..."""
    paced_least: float = 0.25
    """... and for less than this part nobody waits: on a channel that is so much faster than its limit five robots with
    samples of random sizes had 1.1 % of the windows over the limit instead of 0.4, and nothing was won..."""
    paced_ahead: float = 4.0
    """... and plans have windows that are shorter by what so many samples take, for a burst that a plan sends goes one
    after the other: without, the same team filled 82 % of the limit instead of 91, and reached 1.7 % less..."""
    paced_window: float = 0.2
    """... but not by more than this part of a window."""
    alike: float = 0.1
    """A sample whose worth differs by more than this part from what was weighed is decided on its own."""

    undersubscribed: float = 0.7
    """A limit is undersubscribed while all need no more than this part of it..."""
    undersubscribed_new: float = 0.05
    """... and, while any of them is new, no more than this part. Where new streams come all the time searches for each
    of their samples lost others on an idle channel."""
    ample: float = 2.0
    """There is ample room where so many times as much would fit: then it is not looked after each sample whether all
    still does."""
    many_waiting: int = 8
    """With more samples waiting than this there is no time for searches that are not needed."""
    closed: float = 1e-6
    """Windows are closed: what was sent a whole window ago still counts for this moment [s]."""


TUNING = MarketTuning()
