"""The constants of this package."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CongestionTuning:
    """How adaptive limits follow the channel. Times are in seconds, parts are of a limit's ceiling."""

    # Additive increase
    increase: float = 0.025
    """An estimate grows by this part in a second, and by as much more for each second that is calm."""
    calm_after: float = 3.0
    """So long after a decrease it is calm."""
    slow_start: float = 0.5
    """It grows by this part of itself in a second at most: until the first decrease, or up to what others report."""
    untested: float = 1.3
    """It grows to this many times the limit in force at most: what is above that is not tested."""
    used: float = 0.85
    """A limit is used when this part of what is in force is used..."""
    half_used: float = 0.5
    """... or this part, while samples are dropped."""
    dropping: float = 1.0
    """So long after news of a drop samples count as being dropped, or as long as digests are apart: four robots behind
    300 kbit/s, of whom each told something every 8 s, did not grow a limit under which they dropped most samples."""

    # Multiplicative decrease
    below_delivered: float = 0.95
    """A decrease goes to this part of what came through,"""
    mildest_decrease: float = 0.9
    """to this part of what was sent at most,"""
    deepest_decrease: float = 0.5
    """to this part of it at least, or to less in proportion where the queue is longer than..."""
    certain_delay: float = 0.5
    """... this,"""
    repeated_decrease: float = 0.7
    """and to this part of the estimate when the last decrease failed, or in silence."""
    failed_within: float = 1.0
    """The last decrease failed when there is cause for another one so soon after it settled."""
    least_share: float = 0.05
    """When a queue is explained, so much came through at least."""
    settling: float = 0.2
    """So long it takes until the others know of a decrease and have sent what they had decided on."""
    effect_of_others: float = 1.0
    """So long we wait for the effect of a decrease of others."""
    mostly_used: float = 0.6
    """Whole samples never fill a limit: who uses this part of it uses it."""
    decay_interval: float = 1.0
    """Silence decreases the estimates this often."""

    # Queues that drain
    drain: float = 0.5
    """A queue is to drain in this time;"""
    longest_drain: float = 2.0
    """it is given up to this time,"""
    least_while_draining: float = 0.35
    """as this part of the estimate is left to send in any case."""

    # Queue delay
    bearable_delay: float = 0.05
    """Digests may wait so long,"""
    bearable_samples: float = 0.5
    """and so many times what the longest sample takes: robots send independently. With twice what it takes odometry
    of four robots with cameras was 0.23 s old on a radio of 1 Mbit/s, and is 0.14 s."""
    longest_sample: float = 0.25
    """The time of the longest sample counts up to this."""
    base_delay_memory: float = 15.0
    """The least one-way time of so long is the base delay: after that a longer way is taken for what it is."""
    recent_delays: float = 0.8
    """Delays are as old as this at most, or as twice the time between digests."""
    standing: float = 0.25
    """A queue stands that was seen all this time, or for a window of the limits..."""
    longest_standing: float = 0.5
    """... but not longer: bursts of limits with longer windows are taken for queues."""
    standing_times: int = 2
    """At least so many times tell of a queue, of so many paths where there are as many,"""
    standing_apart: float = 0.1
    """and they span this time: robots speak at the same moment when something happens."""
    hopeless_delay: float = 2.0
    """Where the floor is in force and a queue is as long as this, an operator is told."""
    delays_remembered: int = 512
    """One-way times remembered of one direction."""

    # Loss
    excess_loss: float = 0.3
    """More than this part beyond the usual loss is a reason to send less."""
    helped: float = 0.8
    """Sending less has helped when less than this part of the loss is left."""
    ratio_span: float = 3.0
    """A delivery ratio is measured over this time at least,"""
    ratio_messages: int = 40
    """and over so many messages."""
    usual_span: float = 30.0
    """The median of so long is the usual delivery ratio."""

    # Liveness
    overdue: float = 0.35
    """Where much is sent a digest is overdue after this time..."""
    overdue_intervals: float = 2.0
    """... and after so many intervals between our own digests."""
    recently_used: float = 2.5
    """The others speak often if much was used so long ago."""
    silence: float = 2.5
    """Robots speak every second if they may: silence is at least this long..."""
    silence_intervals: float = 3.0
    """... and so many intervals between our own digests."""
    echo_silence: float = 1.6
    """Echoes are rarer than digests by this factor at least,"""
    echo_intervals: float = 2.0
    """and their silence is so many intervals between the last ones,"""
    longest_echo_silence: float = 10.0
    """but no longer than this."""

    # Reports
    look_interval: float = 0.1
    """The channel is looked at this often at most."""
    probe_interval: float = 0.25
    """Our digests are so far apart at most while the channel is in use, if the allowance lets them."""
    lifetime: float = 5.0
    """What a robot reports, and what was measured on its digests, counts for this time."""
    fell: float = 0.98
    """The others hear at once when an estimate fell to this part of what was reported last, or below,"""
    rose: float = 1.15
    """or rose to this many times of it."""
    rate_span: float = 1.0
    """Rates are means over this time at least, where the counts come that often."""
    remembered: int = 64
    """Counts remembered of one robot, delivery ratios, and digests of ours that wait for their echo."""


TUNING = CongestionTuning()
