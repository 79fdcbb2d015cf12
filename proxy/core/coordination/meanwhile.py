"""What a team does that begins with parts, until it has agreed on them for the first time: all plan for all.

No message may fit an equal part. Where all kept to such parts from the beginning, teams of eight and ten robots with
equal messages sent nothing for 3.7 to 4.1 s in unicast and 1.8 to 2.9 in broadcast (20 ms); now the first one goes as
it comes, and no more than five of them are in any window, as many as there is room for.

From the agreement on a robot uses no more than it gives, and still counts what others send: those may have agreed a
little later. One window later all keep to their parts.
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

        Only where large samples come seldom, or may, and news soon. Who joins robots that have agreed on parts cannot
        plan for them, for they announce nothing.
        """
        may = team.splits and not (team.strict or team.quiet) and (team.undecided or team.seldom)
        soon = may and team.news_take(waiting) < TUNING.seldom_news * shortest_window(limits)
        self.plans = soon and not (agreement.newcomer and agreement.others_agreed)
        self.confined = agreement.entitled / UNIT if self.plans and agreement.formed else 1.0
