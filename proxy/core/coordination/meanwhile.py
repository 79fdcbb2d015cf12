"""What a team does that begins with parts, until it has agreed on them for the first time: all plan for all.

No message may fit an equal part: eight and ten robots sent nothing for 1.8 to 4.1 s. From the agreement on a robot uses
no more than it gives, and still counts what others send, for one window.
"""

from proxy.core.coordination.team import Team
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, shortest_window
from proxy.core.protocol.bid import UNIT
from proxy.core.split.agreement import Agreement


class Meanwhile:
    """Whether a robot plans for all while its team splits the limits."""

    def __init__(self) -> None:
        self.plans = False
        """Whether all plan for all."""
        self.confined = 1.0
        """The part of every limit that we use at most then."""

    def over(self) -> None:
        """The team has parts, or needs none."""
        self.plans, self.confined = False, 1.0

    def look(self, team: Team, agreement: Agreement, limits: tuple[Limit, ...], waiting: float) -> None:
        """See how it is before parts have been in force; news of others are `waiting` so long on a full channel [s].

        Only where large samples come seldom, and news soon; not for who joins robots that announce nothing, as they
        agreed.
        """
        may = team.splits and not (team.strict or team.quiet) and (team.undecided or team.seldom)
        soon = may and team.news_take(waiting) < TUNING.seldom_news * shortest_window(limits)
        self.plans = soon and not (agreement.newcomer and agreement.others_agreed)
        self.confined = agreement.entitled / UNIT if self.plans and agreement.formed else 1.0
