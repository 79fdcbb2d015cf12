"""The constants of clock offsets, latencies and losses, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TransitTuning:
    """What is believed of digests, timestamps and counts, and how many of them are looked back on."""

    # Clocks
    drift: float = 200e-6
    """The clocks of two robots drift apart by at most this much: ±100 ppm each [s/s]."""
    resolution: float = 2e-6
    """Times lose this much on the wire [s]."""
    same_time: float = 1e-5
    """Times of one clock that differ by less are the same: a clock stood still, or a digest was rounded [s]."""
    wall_clock_set: float = 5e-4
    """A wall clock that moved by more than this was set [s]."""
    wall_step_told_within: float = 2.0
    """A robot tells that its wall clock was set within this time: samples are read by it only later [s]."""

    # What a sample can have taken
    oldest_arrival: float = 10.0
    """A sample that seems to have taken longer than this says nothing about the way [s]."""
    earliest_arrival: float = 0.005
    """A sample may seem to arrive this much before it was sent, beside what the clock offset may be wrong by [s]."""
    slowest_channel: float = 0.1
    """No channel takes this long for a byte [s/B]."""
    longest_wait: float = 1.0
    """What seems to have waited for longer before it was sent was not the last sample generated [s]."""
    timestamp_mismatch: float = 2.0
    """A timestamp that is further than this from when its sample was sent is of another clock [s]."""
    unheeded_timestamp: float = 0.9
    """Of a sample that was generated this far from its timestamp its robot did not go by it, as it does up to 1 s [s].
    From then to 2 s samples seemed to take as long: other streams of that robot sent 40 samples in place of 116."""
    parts_of_a_second: float = 8192.0
    """Timestamps are read to this part of a second, coarser than what a wall clock tells as a number."""

    # What is remembered of the samples of a robot
    streams: int = 1024
    """Samples of at most this many streams are counted."""
    unread_timestamps: int = 64
    """Of at most this many samples the timestamps are not read yet."""
    slow_sample: float = 2.0
    """A sample that has not come is lost only after so many times what samples take."""
    waits: int = 5
    """Of so many samples it is remembered how long they waited before they were sent."""
    digests_awaiting_echoes: int = 64
    """Of so many of our digests it is remembered what had been sent by then."""
    latency_refresh: float = 0.5
    """What samples take is worked out anew this often while they come [s]."""

    # What samples took is forgotten when none confirms it
    unconfirmed_for: float = 10.0
    """No sample came for this long [s],"""
    gap_fade: float = 0.9
    """nor for so many of the longest gaps, which each sample that comes sooner shrinks to this part,"""
    unconfirmed_gaps: float = 3.0
    """which are so many."""
    quicker_ratio: float = 0.5
    """And digests take less than this part of what the samples took,"""
    quicker_by: float = 0.05
    """less this [s]: it was learnt in a queue, which may be why no sample comes."""

    # The line through what messages took, by their size
    messages_of_a_size: int = 16
    """So many messages of each class of sizes are looked back on."""
    messages_for: float = 60.0
    """Messages that came so long before the newest one count no more [s]."""
    fewest_messages: int = 3
    """A class of fewer messages says nothing about the slope, and as few of all sizes say nothing at all."""
    distinct_size_ratio: float = 1.5
    """Sizes with a smaller ratio than this count as one."""
    size_classes: int = 24
    """Classes of sizes, each of which begins at twice the size of the one before; the last holds 8 MiB and more."""

    # Losses
    loss_readings: int = 32
    """So many readings of the counts are looked back on: at least 124 samples."""
    samples_between_readings: int = 4
    """At least so many samples lie between two readings that are kept."""
    fewest_samples: int = 20
    """A loss among fewer samples counts as one among so many: some of them are only on their way."""


TUNING = TransitTuning()
