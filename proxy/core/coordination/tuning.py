"""The constants of coordination."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CoordinationTuning:
    """Each with what it is for, and the measurement behind it where there is one."""

    interval: float = 0.25
    """Whether the team has to split, what we ask for and what we use is looked at this often [s]."""
    late_news: float = 0.25
    """News are late that take this part of the shortest window: five robots lose 4 to 21 % in `split` at a fifth."""
    late_digests: int = 3
    """So many late digests in a row say that a queue makes news late: else four robots filled 2.8 limits for ever."""
    affordable: float = 0.8
    """Announcements cost too much where they take this part of the allowance..."""
    affordable_few: float = 0.5
    """... and more by this for each equal part that messages take beyond..."""
    many_to_a_part: float = 0.2
    """... this, as few of them to a part leave much of it: cameras of four robots with frames of 3 to 30 kB reach 94 %
    of a central decider so, and 90 in parts..."""
    affordable_at_most: float = 0.88
    """... up to this, as digests take a part, too: two drawn workloads that take 0.9 to 0.96 of it reach 87 and 100 %
    of central in parts, and 72 and 85 % where they announce..."""
    affordable_turns: float = 1.2
    """... or this one, where messages are larger than an equal part and would go by turns: five drawn workloads that
    take 0.8 to 1.1 of it reach 77 to 94 % of central so, not 46 to 83; 265 others 0.3 points more in the mean..."""
    seldom_period: float = 0.25
    """Samples come seldom that are so far apart at least [windows]..."""
    seldom_size: float = 0.2
    """... and are no larger a part of a limit: a team splits then (ten robots: 95 to 100 % of a central decider)."""
    seldom_news: float = 0.1
    """A team that splits so plans for all until it has parts where news take less than this part of a window."""
    overheard_news: float = 0.2
    """Where such are overheard a team splits where news take this part of the shortest window (300 ms: 91 to 99 %)."""
    announced_news: float = 0.02
    """In unicast each is announced where news take less than this part of the shortest window..."""
    announced_part: float = 0.05
    """... all that robots tell each other is no more than this part of a limit..."""
    announcing_robots: int = 13
    """... and there are no more robots than these: twelve reach 97 to 99 % so, in parts 74 to 77; sixteen 64 to 70."""
    rhythm_time: float = 1.5
    """Who begins splits until it knows how often its large samples come: so long at most [s]."""
    ways_time: float = 10.0
    """Who begins and broadcasts splits so long at most until it knows how long news take [s] (88 to 92 % at 1 s)."""
    dear_time: float = 2.0
    """... a small team changes over when they have for so long [s]: what few samples say of sizes and rates varies."""
    hysteresis: float = 0.8
    """News are late, or announcements dear, still when it is a little less: so many times that."""
    few_robots: int = 16
    """Of more robots than these some have something to send, though nobody may have heard of it yet."""
    large_team: int = 25
    """So many other robots are too many to agree on parts: it takes them half a minute, fifty a whole one."""
    most: float = 0.6
    """Of such a team all are taken to send where this part is known to: of thirty 25 were after 20 s."""
    even_parts: float = 3.0
    """Where announcements cost too much equal parts do if no message is larger than so many (87 %, agreeing 62)..."""
    even_robots: int = 3
    """... so many robots have something to send..."""
    even_streams: float = 3.0
    """... and so many streams each, so that they are alike: of robots with one camera who sees more needs more..."""
    even_size: float = 0.02
    """... where those do not count that are so much smaller than the robot's largest one..."""
    slow_words: float = 2.0
    """Where one word of each robot to every other takes longer than this, who cannot agree has equal parts [s]."""
    passed_on: float = 0.5
    """Nor are slots worth their words that are worth no more than equal parts, where passing them on takes this part of
    the allowance (six drawn workloads: 46 to 76 % of a central decider, now 66 to 81)."""
    varied_margin: float = 0.06
    """Where several plan for all, and all large samples vary, so much of limits is left: 0.9 % over, not 2.9 (20
    ms)."""
    varied_sizes: float = 0.25
    """Sizes vary that deviate by more than this part of their mean."""
    forming_time: float = 5.0
    """A team that begins has so long to agree on parts before all other announcements go on [s]."""
    agreement_time: float = 6.0
    """Robots that have not agreed on parts for so long [s]..."""
    agreement_news: float = 20.0
    """... and so many times as long as news take never will: they plan for all, else nobody sent for a minute..."""
    retry_time: float = 60.0
    """... and try again so much later [s], and each time in vain twice as late..."""
    longest_retry: float = 960.0
    """... up to this."""
    hollow_time: float = 4.0
    """Claims of others are looked at after so long [s]..."""
    hollow_windows: float = 6.0
    """... and so many windows..."""
    hollow_patience: float = 5.0
    """... or so many times as late at most where not all have told, and where robots may tell each other little..."""
    hollow_words: float = 60.0
    """... as late as they can have, up to this [s]..."""
    hollow_put_off: float = 2.0
    """... and so many times as late as that where robots come and go meanwhile; they are hollow where..."""
    hollow_sent: float = 0.8
    """... less than this part of what we generated was sent..."""
    hollow_own: float = 0.7
    """... we used less than this part of an equal part..."""
    hollow_use: float = 0.25
    """... and all of us together, as far as it is confirmed, less than this part of a limit..."""
    hollow_message: float = 3.0
    """... and not all messages of ours take more than so many equal parts: such a part is safe for none of these. Of
    twelve robots with samples of 0.2 to 1 limits, which use little as they can say little, eleven took each other's
    claims for hollow: 24 % of the windows were over the limit, by up to 2.4, and 3 % so, by up to 1.3."""
    hollow_untold: float = 0.5
    """Where somebody has not told what came of a robot, so much of an equal part is believed."""
    certain_part: float = 0.125
    """This part of an equal part is left to each robot for small samples whatever others say to have sent."""
    certain_message: float = 0.25
    """A message takes no more than so much of that: else two of 500 B took it from half of those of 20 B."""
    whole_part: float = 0.95
    """Who has so much of a limit may take it all for a message that is larger."""

    least_limit: float = 1e-6
    """A constraint cannot be zero; this is as good."""
    departure_weight: float = 0.1
    """How long large samples take to leave: the last has this weight unless it took longer."""
    stretched_windows: float = 16.0
    """Sends are remembered for so many windows at most: the window of a larger message is not stretched further."""
    remembered_limits: int = 512
    """So many times limits may become others while what was sent before still counts: some times a second where they
    follow the channel."""
    beside_bulky: float = 0.25
    """A window is stretched for a message that would fit alone if what is sent beside takes no larger part of a limit
    (`Stretch.weigh`)."""
    beside_oversized: float = 0.05
    """So much of a stretched window is left beside what is booked: small samples come in no even number."""

    deciding: float = 0.01
    """What is decided elsewhere is on its way so much later than generated [s]: with half 2.1 % over, not 1.2."""
    late_deviations: float = 2.0
    """A sample may come so many standard deviations later than due: with one 20 times as many windows were over..."""
    late_part: float = 0.2
    """... but by no more than this part of the period (ten robots reached one percent less with half of it)."""
    undecided_news: float = 2.0
    """What generates at random and may have given way is undecided for so many times as long as news take."""
    opening_part: float = 0.25
    """Part of the way that news take; without it the room seemed to open too early in 1 % of the windows."""
    larger_deviations: float = 1.5
    """What may have been sent is so many deviations larger than usual: else 2 % of windows of four robots were over."""
    caution: float = 0.3
    """What comes at random counts as taken by this power of its probability (with 0.25 94.6 to 97.1 %, now 95 to
    98)."""
    first_time: float = 0.4
    """Who begins to send lets others that may begin at the same moment go first for so long at most [s]..."""
    first_few: int = 2
    """... where more than so many may: two robots and an operator filled one first window of eight to 1.3 limits..."""
    first_part: float = 0.2
    """... each in this part of its turn, so that the next one hears of it."""
    claim_worth: float = 0.2
    """Of what a sample is worth by itself this part counts in a claim."""
    claim_tolerance: float = 0.003
    """Clocks round: who has the later name counts as silent for so much longer, or both find theirs the best [s]."""
    claim_pays: float = 0.6
    """Nobody gives way to samples that earn less than this part of their room's cost: with 0.4 twelve robots with large
    samples at random used a third of the limit, and with 0.6 two thirds."""
    due_samples: int = 16
    """Of bursts the newest sample is among so many of a period."""

    worthless: float = 3600.0
    """Messages are worth nothing any more after this [s]."""
    too_late: float = 1.5
    """Messages that take so many times as long as they are worth anything are not asked for."""
    new_stream: float = 4.0
    """A new stream may generate so many times as much in a window as so far: an alarm asked for two thirds of all."""
    size_deviations: tuple[float, ...] = (-1.2, -0.7, -0.2, 0.2, 0.7, 1.2, 2.0)
    """Sizes of a stream are taken to be so many standard deviations from their mean."""

    use_memory: float = 5.0
    """What a robot uses of an equal part counts by exponential weights with this time constant [s]..."""
    agreed_memory: float = 10.0
    """... of one that all agreed on with this one [windows]; with ten windows of 1 s of equal parts 2.4 % of windows
    of eight robots more were over the limit..."""
    use_known: float = 0.4
    """... and not before it was looked at for this part of that."""
    use_deviations: float = 1.5
    """Room for so many standard deviations of what all use is left (2.5: fifty robots 92.5 % of central, not 93.6)."""
    agreed_deviations: float = 2.5
    """And for so many where robots agreed on parts, as they use them unalike: with 1.5 up to 6 % of the windows of
    twelve unequal robots were over the limit, and their teams reached up to 2 % more."""
    few_deviations: float = 4.0
    """And for as many more as this divided by the robots: half of it left six robots with 3.8 % of the windows over."""
    turn_parts: float = 1.5
    """Messages that are larger than so many equal parts go by turns; in a small team all do then that are larger than
    one: of six robots those that took 1.4 parts, and went without, had 6 % of the windows over the limit."""
    turn_step: float = 1.15
    """Robots are rounded up to a power of this for turns."""
    turn_size: float = 1.05
    """Slots of a large team are so much larger than its largest messages: 28 cameras that broadcast reach 10 % more. So
    much more than the mean is saved for a message, too, as sizes vary."""
    turn_told: int = 8
    """So many of the largest sizes that a state tells are looked at: to find who wants 10,000 keys takes 4 s."""
    small_counts: float = 1.4
    """Before a turn what went without one counts so many times, as what others send so varies: of five drawn workloads
    of twelve robots 7.8 % of the windows were over without that, and 3.5 are."""
    turn_time: float = 0.1
    """A turn lasts for this part of a window, as clocks differ: samples wait for it..."""
    turn_guard: float = 0.05
    """... and what is sent in it may take so much more of a window until it counts."""
    overbooked: float = 2.0
    """No robot uses more than so many times its part of a window."""


TUNING = CoordinationTuning()
