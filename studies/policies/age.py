"""Whittle's index for weighted age of information: what schedulers of the freshest information go by.

A source whose age costs `f(a)` a second, and whose updates cost λ each, sends whenever its age reaches some `a`. Both
sending and waiting are right at that age when the mean cost `(∫_0^a f + λ) / a` is what the next instant costs, `f(a)`;
so an age of `a` is worth

    W(a) = a·f(a) − ∫_0^a f(x) dx,      which for the weighted age f(a) = w·a is  W(a) = w·a²/2

an update (in slots w·a(a + 1)/2: Kadota et al. 2018, "Scheduling policies for minimizing age of information in
broadcast wireless networks"; for any f Tripathi and Modiano 2019, "A Whittle index approach to minimizing functions of
age of information"). A scheduler gives the channel to the greatest indices; so does WiSwarm (Tripathi et al. 2023)
among the cameras of a team of drones.

The age that counts is what an update takes away: how much later it was generated than the last message received. How
messages fade is not asked, only what they weigh.
"""

from planner import Message, Problem
from studies.policies.ranked import fits_by_rank, share


def by_age(window: Problem) -> bool:
    """Send when the message's stream is among those of greatest index per share of a limit that fill the room.

    Its competitors are the next messages of the other streams within the longest constraint window from now on. Where
    nothing of a stream was sent it is as old as the mission.
    """
    current = window.messages[window.current]
    until = current.t_sent + max((c.window for c in window.constraints), default=0.0)
    shown: dict[int, Message] = {}
    rivals: dict[int, int] = {}
    for index, message in enumerate(window.messages):
        if message.sent:
            shown[message.stream] = message
        elif message.t_sent <= until and message.stream != current.stream:
            rivals.setdefault(message.stream, index)
    rivals[current.stream] = window.current
    worth = {i: _index(window.messages[i], shown, window.t_start) / share(window, i) for i in rivals.values()}
    return fits_by_rank(window, worth)


def _index(message: Message, shown: dict[int, Message], t_start: float) -> float:
    """Return w·a²/2 of the age that a message takes away; 0 for one that is older than what was sent."""
    last = shown.get(message.stream)
    gained = message.t_gen - (t_start if last is None else last.t_gen)
    return message.scale * max(0.0, gained) ** 2 / 2.0
