"""The constants of what robots tell each other: sizes, shares of the allowance, and timers."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GossipTuning:
    """One field for each constant. Debts and savings are counted in seconds of the whole allowance."""

    # What messages take on the air.
    overhead: int = 15
    """What Zenoh adds to a digest: the length of the batch, its frame, and the number for the key [B]."""
    announcement: int = 16
    """An announcement is about so large [B]."""
    on_air: int = 60
    """What the key takes besides the robot's name where digests are broadcast [B]."""
    question: int = 75
    """What asking for a state takes, the head of the answer included [B]."""
    answer: int = 75
    """A state without streams is about so large [B]."""
    echo: int = 23
    """What an echo takes [B]."""

    # Shares of the allowance.
    digests: float = 0.95
    """For digests, or all where limits follow the channel: with all of it robots told 103 to 105 % of what they may."""
    ordinary: float = 0.2
    """For all but announcements, beside what these do not need."""
    ordinary_on_channel: float = 0.7
    """The same where limits follow the channel, as how long digests take tells of it."""
    states: float = 0.5
    """For states, questions and answers, while there are any."""
    echoes: float = 0.25
    """For echoes in the long run, of what a robot has for ordinary news."""
    echoes_ahead: float = 600.0
    """What echoes may take ahead of that [B]: without any nobody knows how long the way is."""
    patience: float = 2.0
    """A robot waits for the others to leave it room for at most so many times what its part takes to pay for a digest:
    beside one that said fifty a second two of four robots used 28 % of the limit for good."""
    beside: float = 0.4
    """A digest of any size may go where the window holds up to this part of what may be told in it: eight robots whose
    digests took nearly all of it told them after some time at one moment (1.6 % of windows over, now 1.3)."""
    answers: float = 1.5
    """What all robots answer takes so many times what the allowance has room for meanwhile: other news go on beside."""
    fewest_sends: float = 2.0
    """A team is taken to send at least so many messages in a window that have to be announced."""

    # What may be spent ahead of time, saved and owed.
    announcement_debt: float = 5.0
    """Ahead of time on announcements [s]."""
    overheard_debt: float = 1.0
    """The same where samples are overheard [s] (eight robots told 117 % of what they may in 12 s, and tell 100)..."""
    overheard_loss: float = 0.05
    """... and less than this part of them is lost: at 30 % 15 to 34 % of the windows were over, not 3 to 6."""
    retransmission_debt: float = 2.5
    """Ahead of time on announcing again [s]: at 30 % lost ten robots had 16 % of the windows over the limit with 1 s,
    10 with this, 6 with 5, but five with samples of random sizes told 117 % of what they may then instead of 108."""
    first_parts_debt: float = 10.0
    """Ahead of time on the first agreement on parts [s]."""
    parts_debt: float = 0.5
    """Ahead of time on news of parts later [s]..."""
    parts_in_debt: float = 0.5
    """... for which this part of the allowance is left while what was spent on the first agreement is paid for: else
    nobody passed a slot on for 8 to 10 s (six robots: 75 % of a central decider, not 67)."""
    first_parts_savings: float = 15.0
    """Saved for the first agreement on parts [s]: nobody sends meanwhile, but for the floor."""
    state_savings: float = 10.0
    """Saved for states [s]."""
    spare: float = 0.25
    """What is not spent is left for later up to this [s]."""
    deepest_debt: float = 10.0
    """Owed at most [s]: who tells more than its part silences nobody for long."""
    deepest_state_debt: float = 50.0
    """Owed at most for states, questions and answers [s]: else floods of questions silenced a robot for 16 minutes."""

    # When digests go, and what is in them.
    slowest_digest: float = 1.0
    """A digest goes out at least this often, and each peer is echoed at most so often [s]."""
    nothing_sent: float = 3.0
    """The same in unicast where nobody sends, and ways are known [s]: half of what an idle robot of eleven did."""
    relaxed: float = 0.25
    """Where there is room for all, or nobody else sends, ordinary news are so far apart at least [s]: a digest for each
    of 200 small samples per second took half of the sender's time. Not where limits follow the channel."""
    digests_apart: float = 1e-3
    """Two digests are so far apart at least [s]: each is told from the others by its time."""
    parts_apart: float = 0.05
    """Digests with news of parts are so far apart at least [s]."""
    unhurried: float = 60.0
    """Where nobody plans with it ordinary news wait for the allowance of all for so long [s]; not where digests tell of
    the channel, where three robots silent for 3 to 5 s sent 10 to 40 % less."""
    streams: int = 32
    """News of at most this many streams in one digest..."""
    news_bytes: int = 6144
    """... and of so many bytes [B]: the rest of what others read is for echoes, limits and parts."""
    news: int = 70
    """News of a stream takes so much at most [B]..."""
    feature: int = 9
    """... and so much for each of its features [B]: a large whole number."""
    echoed: int = 8
    """Peers echoed in one digest."""
    refresh_after: float = 10.0
    """What was announced of a stream is announced again after this time: it may have been lost [s]."""
    refreshed: int = 2
    """Streams announced again in one digest."""
    surely_over: float = 0.1
    """That a stream ceased is told so much later than it is taken to be over [s]: others find that, too, then."""
    value_change: float = 0.25
    """Others plan anew where the value of a stream changes by this part."""

    # When announcements on the air are sent again.
    retransmit_after: float = 0.03
    """An announcement is sent again after so long, then after twice as long, and so on [s]."""
    missed: float = 0.003
    """It is sent until no more than this part of the robots have missed it, by what is lost in the mean."""
    sent_so_far: int = 2
    """Who missed it missed the sample and its announcement, two times."""
    retransmissions: int = 3
    """It is sent again so often at most."""

    # When states are announced, and what is news of them.
    states_apart: float = 0.2
    """States follow each other at least this far apart [s]..."""
    states_part: float = 0.05
    """... and as this part of how long one of about so many bytes takes our part of the allowance for states..."""
    state_update: int = 45
    longest_apart: float = 1.0
    """... or so long [s]: of eight to twelve robots that begin on 0.3 Mbit/s each told of its streams one by one, for
    30 s of the allowance, and was silent after that (92.1 % of central for 91.7; three of them 68 to 80, 76 to 81)."""
    gather: float = 0.25
    """New streams that are not large are announced so late, together [s]; large ones as soon as states may follow:
    else eight robots knew of each other's cameras after 2 to 5 s."""
    review_every: float = 1.0
    """While samples come, our state is looked at this often: whether the periods are still right [s]."""
    period_change: float = 0.1
    """Periods are estimates: only one that moved by this part of the longer one is news."""
    random_period_change: float = 0.5
    """The same where samples come at random, as 32 of them vary by a sixth (with a tenth robots told 122 %)."""
    size_change: float = 0.5
    """Sizes are news from this change on, as every digest has them."""
    wall_clock_step: float = 1e-3
    """A wall clock that moved by more than this is news [s]."""

    # When robots are asked for their states.
    questions_apart: float = 0.02
    """Questions follow each other at least this far apart [s]."""
    questions_at_once: int = 8
    """So many questions do; more may have to wait, as a team of fifty that begins has 2,450 of them."""
    first_answer: float = 0.5
    """An answer is waited for this long, the next ones twice as long each [s]."""
    longest_wait: float = 30.0
    """An answer is waited for up to this [s]."""
    update_delay: float = 0.3
    """An update of a state may come so much later than a digest that names it [s]."""


TUNING = GossipTuning()
