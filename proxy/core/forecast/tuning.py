"""The constants of this package."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ForecastTuning:
    """What decides which pattern is seen in generation times, and how features are forecast."""

    # Rhythms
    short_memory: int = 16
    """So many generation times tell a rhythm..."""
    memory: int = 48
    """... and so many a tight one, whose period is known five times as well then (1.1 % of windows over, not 1.7)."""
    better_line: float = 1.93
    """What 48 samples tell holds unless the squares of the last 16 are smaller by this factor on their own line: 1 + 2
    F / 14 with the 99 % quantile of F(2, 14), so by chance it does not once in a hundred."""
    least_period: float = 1e-4
    """What is faster than times travel is no rhythm [s]."""
    exact: float = 1e-4
    """Deviations below this part of the period are never too far: clocks and the wire round."""
    far: float = 4.0
    """So many median deviations from the line is too far for the line to be fitted to it."""
    wandering: float = 0.75
    """Jitter's variance over that of its steps: 1/2 where deviations are independent, 1 (of 16) where they add up,"""
    walk: float = 96.0
    """and grows as these do, so that the bound does: by one in so many."""
    few: int = 6
    """With fewer samples the jitter is not known: it is taken for a tenth of the period at least."""
    least_jitter: float = 0.02
    """... but for when the next one comes, where this part of it is enough: a tenth held up others for too long."""
    gate: float = 4.0
    """A sample may be so many times the jitter off its time,"""
    least_gate: float = 0.1
    """and this part of the period."""
    run: int = 3
    """So many in a row are no chance: gaps of another period, suspects, bursts, samples before the last one."""
    unlike: int = 5
    """So many suspects without anything in common are no outliers."""
    seldom: int = 6
    """A long line is fitted, and the spread of gaps is found, every so many samples: it takes ten times all else."""
    any_time: float = 0.3
    """With jitter of more than this part of the period a sample may come at any time."""
    tight: float = 0.12
    """Rhythms of less jitter than this part of the period are known by more samples."""
    alike: float = 1.6
    """Steps of up to this ratio are of one period."""

    # Kinds of streams
    no_rhythm: float = 0.3
    """Jitter of more than this part of the period is no rhythm, neither of samples nor of the starts of bursts."""
    hysteresis: float = 0.05
    """What a stream was, it stays for a little longer."""
    sure: int = 12
    """So many samples have no rhythm by chance;"""
    random_spread: float = 0.45
    """Samples come at random whose gaps deviate by more than this part of them."""
    burst_pause: float = 3.0
    """The shortest pause is at least so many times as long as the longest gap within a burst."""
    burst_sizes: int = 2
    """Of a few bursts the largest has so many times the members of the smallest at most; what is longer is none."""
    most_members: int = 10_000
    """A burst that is reported has so many members at most."""

    # The end of a stream
    lone_timeout: float = 10.0
    """A stream of one sample may be silent for so long before it is over [s]."""
    least_timeout: float = 1.5
    """A stream of several samples is not over sooner [s]: applications are held up for a moment."""
    timeout_periods: float = 4.0
    """Other streams are over after so many of their periods (of unequal teams whose streams pause for 5 to 15 s twenty
    reached 93.2 % of a central decider with ten, 94.4 so),"""
    pause_periods: float = 10.0
    """A gap of so many periods is a pause, though the stream was not over: what comes then has another beginning."""
    timeout_gaps: float = 3.0
    """and not before so many times the longest gap between two samples that they lately made."""
    random_gap: float = 3.0
    """What comes at random makes gaps of so many intervals often: else eight robots told each other again and again
    that such streams ceased, and reached 86.6 % of a central decider, not 92.1."""
    gap_fade: float = 0.97
    """Gaps are forgotten: at each sample the longest shrinks by this."""

    # Reports and specs
    fewest: int = 4
    """A rhythm that is reported was found from so many samples at least."""
    rule_recent: int = 8
    """So many of the last samples tell how far a stream is off its written times."""

    # Features
    values: int = 16
    """Values of a feature looked back on."""
    young: int = 6
    """With fewer errors no method is chosen: the last value will do."""
    better_method: float = 0.9
    """Another method must have erred by less than this part of what the first one did."""
    error_fade: float = 0.9
    """Errors are forgotten: each weighs so much of the next one."""


TUNING = ForecastTuning()
