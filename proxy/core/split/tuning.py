"""The constants of the split."""

from dataclasses import dataclass

from proxy.core.protocol.bid import STEPS, UNIT


@dataclass(frozen=True, slots=True)
class SplitTuning:
    """Each with what it is for, and the measurement behind it where there is one."""

    newcomers: int = 4
    """So many robots may come at once: each has this part of the floor until all know it."""
    tables_kept: int = 8
    """Tables that are kept one by one; of those between the oldest and the newest, the least part is kept."""
    bids_kept: int = 256
    """Bids that are kept of robots, those that are gone included."""
    unequal_gain: float = 1.15
    """Parts are much better than equal ones that are worth so many times as much to all who have them."""
    slot_gain: float = 0.1
    """Slots change hands where all together gain so much, as until all agree each has the least that any table gives
    it: else four cameras reached 91 % of a central decider, now 93, ten robots 75 to 91, now 79 to 94."""
    gains_for: float = 30.0
    """Parts are asked for that pay for the time that it takes to agree within so long [s]: of twelve robots that take 7
    to 11 s three asked for a little more each, and all gave up."""
    message_growth: float = 1.1
    """Slots change hands, too, where we could send messages that are so many times as large."""

    assured_part: int = 8
    """Every robot gets what it asks for up to an equal part by this, before values count: so nobody is silent."""
    slot_pieces: int = 16
    """A slot is shared in time by so many pieces: so many robots can ask for it alike."""
    turn_ratio: int = 4
    """A turn is at most so many times as long as another one of its slot, so that nobody waits for long."""
    alike_part: float = 0.125
    """Amounts are about the same, and not worth an agreement, that differ by no more than this part..."""
    alike_units: int = 50
    """... and so many units: frames of four robots of *mixed* traffic reach 61 % of central so, not 48."""
    urgency_levels: int = 4 * STEPS
    """Who gains sixteen times as much by a message has the first turn with a slot."""
    whole_slot: int = UNIT // 2
    """A message larger than the limit needs a slot of at least so many units, and gets what is left, too."""

    small_message: float = 0.05
    """Messages up to this part of a limit are asked for as divisible room, at most half of an equal part."""
    rate_shares: tuple[float, ...] = (0.125, 0.25, 0.5, 1.0)
    """Small messages are valued at such parts of their rate: with one value eight robots reached 67 %, not 98..."""
    much: float = 0.5
    """... where a stream asks for more than this part of an equal one: else 84 % of odometry was sent at 300 ms."""
    spare_deviations: float = 3.0
    """Room beside the mean is asked for as so many standard deviations of what is generated in a window..."""
    spare_levels: int = 2 * STEPS
    """... at so many levels less: robots of *mixed* traffic send 99 % of small samples, with room for one more 83."""
    divisible_segments: int = 4
    """Segments of small messages."""
    sizes: int = 8
    """Sizes of a stream at which its value is looked at."""
    multiples: tuple[float, ...] = (2.0, 3.0)
    """More than one of the largest messages in a window is asked for up to so many."""
    packing: float = 0.85
    """What of a part is used by messages that vary in size: there is seldom one for all that is left."""

    bid_interval: float = 2.0
    """A bid changes no sooner after it changed last [s]; sooner in the first seconds, when streams become known."""
    agreement_rest: float = 2.0
    """Nor does it sooner after all agreed than so many times what agreeing took: a third of the time is for that."""
    repeat_after: float = 0.05
    """What is told twice is told again so much later [s]."""
    request_delay: float = 1.0
    """Who misses something requests it after so long [s]..."""
    request_news: float = 2.0
    """... and so many times what news take; then twice as late..."""
    request_doublings: int = 3
    """... so often at most: it is never more than eight times as late."""
    turn_news: float = 15.0
    """A turn lasts at least so many times what news take: then passing slots on costs about a fifteenth of them."""
    round_time: float = 40.0
    """Where news take long, turns are so short that everyone's comes this often [s], if they are to last one window."""


TUNING = SplitTuning()
