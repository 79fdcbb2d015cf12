"""The constants of the shared view, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ViewTuning:
    """How much is known of how many, what is believed, and for how long."""

    # How many are known
    peers: int = 256
    """Robots in the view; of more, one that said nothing yet leaves for the new one."""
    unknown_senders: int = 64
    """Robots listened to whose presence is not known yet."""
    unknown_digests: int = 4
    """Digests kept of each of them."""
    pending_news: int = 1024
    """Streams of one robot of which news is kept until their keys are known."""
    matching_keys: int = 4096
    """Our keys of which it is known that somebody on the mesh wants them."""
    keys_answered: int = 8192
    """Keys of which it is remembered who wants them."""
    subscriptions_narrowed: int = 256
    """Subscriptions that are narrowed to the keys of information types; of more, all of those keys are meant."""
    wildcards: int = 3
    """`**` and `$*` in one key expression. Zenoh takes exponential time for many: who asks with more wants all..."""
    compared_places: int = 16_384
    """... and so does who asks with two or three, for a key in which these have more places: to compare `$*a$*a$*b`
    with a key of a thousand letters took 1.7 s, so few take 0.1 ms at most."""
    patterns: int = 128
    """Key expressions with wildcards of one robot; who asks with more wants all: a thousand of them, which change,
    beside a thousand streams held up all decisions for 15 s, so many for 0.4."""
    sends: int = 16_384
    """Sends of other robots that are looked back on."""
    sends_of_stream: int = 512
    """Sends of one stream that are looked back on."""
    untold_sends: int = 32
    """Sends of a stream that nobody told us of and that are made up for, at most, when a later one is told."""

    # How long what is known holds
    windows_kept: float = 1.5
    """Others' sends are remembered for so many of the longest windows: who waited for the room they left may send."""
    plain_check: float = 10.0
    """It is looked for plain nodes that fell silent this often [s]."""
    plain_silent: float = 60.0
    """The streams of a plain node are forgotten after this long [s],"""
    plain_silent_periods: float = 5.0
    """and after so many of their periods."""
    ways_refresh: float = 0.2
    """Who gains by a stream, and how late, is looked at anew this often [s]."""
    small_team: int = 10
    """That is done more rarely in a larger team than this, by as many times as it is larger."""
    size_digits: int = 5
    """Streams have one audience whose sizes differ only beyond so many binary digits: looking took half of weighing."""

    # What one robot may say
    implausible_for: float = 10.0
    """What does not follow from a robot's last digest, or a stream's count, is refused for so long [s], then new."""
    digest_delay: float = 30.0
    """A digest may come this much sooner after the one before than it was sent [s]."""
    digest_ahead: float = 1.0
    """A digest may tell of what happens this long after it was sent [s]."""
    fastest_count: float = 20_000.0
    """Samples of one stream, or messages of one robot, in a second."""
    fastest_bytes: float = 1e10
    """Bytes of one robot in a second."""
    count_burst: float = 60.0
    """Counts may run ahead of these rates by so much time [s]."""

    # Robots that come, and robots that take no part
    newcomer_time: float = 10.0
    """In a large team it takes this long until all have told all what they send [s]..."""
    newcomer_words: float = 6.0
    """... or until each has said so many words to every other, where they may tell little..."""
    newcomers: int = 16
    """... in a team of no more others: of thirty that only listened each was taken to send for half a minute..."""
    newcomer_doubt: int = 3
    """... and of those that told nothing such a part sends as of the others, after so many more that do..."""
    word_size: int = 60
    """... of which few are smaller [B]."""
    greeting_time: float = 0.25
    """Who has just been met tells what it sent lately within this time [s]."""
    silent_since_start: float = 2.0
    """Who has sent nothing for this long since we do is not about to [s]."""
    word_time: float = 1.0
    """Who has just been met and says nothing for so long takes no part until it does [s] (else 7 of 18 frames went)."""
    doubt_time: float = 60.0
    """Since somebody came without a word, who comes takes part from the first word on, for so long [s]."""
    team_begins: float = 5.0
    """A team of which somebody has been known for so long has begun: newcomers take part from the first word on [s]."""
    agreement_time: float = 5.0
    """Within this time a newcomer says something, and specs are changed on one robot after the other [s]."""
    telling_robots: int = 20
    """In a larger team it takes longer until all could tell that their specs have changed..."""
    telling_per_robot: float = 1.5
    """... by this for each robot more [s]: of thirty the last one had told after 12 s, of forty after 24."""
    agreement_per_robot: float = 0.05
    """A newcomer has this much more for each robot there is, for all of them have to be asked [s]."""
    understood_for: float = 300.0
    """A robot that is understood tells all something more than twice in this time, whatever the allowance [s]."""
    mismatch_check: float = 0.5
    """It is looked for robots that take no part this often [s]."""

    parting_time: float = 2.0
    """Samples of a robot that left may still come for so long [s]; after that they are a plain node's."""

    # Clocks and ways
    peers_always_echoed: int = 4
    """Of no more peers than these each is echoed as soon as it is met."""
    unechoed_after_meeting: float = 2.0
    """Of more, who was met this lately is not echoed [s]: else two took their clocks for 72 ms apart for 20 s."""
    least_latency: float = 1e-6
    """What is told of a way takes at least this long [s]: nothing at all stands for nothing known."""
    clock_warning_above: float = 0.05
    """Wall clocks that are further apart than this are worth a warning [s]."""
    clock_warning_ends_below: float = 0.04
    """The warning ends when they are no further apart than this [s]."""
    untold_clock_step: float = 2.5e-3
    """Two wall clocks may have moved so much against each other and nobody said so, because it is too little [s]."""
    digest_delays: int = 64
    """How long news is delayed, so many of the last digests tell."""
    digests_in_time: float = 0.9
    """This part of them came with less delay than what is told."""
    usual_digest: int = 150
    """A digest is about so large on the way [B]."""
    most_loss: float = 0.95
    """A robot that gets less than the rest of our samples is not given up: it may get better."""
    receiver_groups: int = 4
    """Receivers are told apart by their latencies in so many groups at most: each makes a decision slower."""
    alike_latency: float = 1e-3
    """Latencies that round to the same multiple of this are one group [s]."""

    # Streams
    same_sample: float = 1e-3
    """A sample that was generated so much after the last one was sent is another one [s]."""
    same_stamp: float = 2e-3
    """So is one that by its timestamp was generated so much after the last one that was told [s]."""
    told_sample: float = 0.25
    """One that seems to have been generated sooner than this part of the period after a send that was told and not
    heard yet is that one: counted twice over ns-3 it cost ten robots with equal messages 5 % of utility."""
    same_size: float = 0.1
    """So is one of the same size generated so soon after [s]: else up to 5 % of windows of four robots were over."""
    least_period: float = 1e-3
    """Streams are taken to generate no faster than so [s]."""
    leads: tuple[int, ...] = (1, 4)
    """Features that change are forecast for so many periods ahead: for the next sample, and for all later ones."""
    newest_size_weight: float = 0.1
    """What the size of a new sample counts in the mean and the variance of sizes."""
    sent_size_deviations: float = 0.3
    """Where sizes vary, those sent are smaller than the mean by so many standard deviations: plans of five robots
    reached 94.2 % of the bound, with the mean 93.3."""
    least_likely_size: float = 0.5
    """No sample is planned with a smaller part of the mean size."""
    smallest_size_part: float = 0.2
    """The smallest samples are not taken to be smaller than this part of the mean size."""
    told_by: int = 4
    """What others' samples take counts as so many receivers tell it: in a team of 25 all would be 600 numbers."""


TUNING = ViewTuning()
