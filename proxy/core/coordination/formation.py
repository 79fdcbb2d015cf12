"""How a team comes to parts of its own: those that it begins with, or changes over to."""

import math

from proxy.core.coordination.team import Team
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, shortest_window
from proxy.core.protocol.bid import UNIT
from proxy.core.split.agreement import Agreement


class Formation:
    """How far the team is; a `strict` one has parts from the beginning."""

    def __init__(self, now: float, *, strict: bool) -> None:
        self.established = strict
        """Whether parts that take in what all ask for were in force for a window; until then all have equal ones."""
        self._split = strict
        """Whether parts were in force when it was looked last."""
        self._until = now + TUNING.forming_time
        """Until when all other announcements have time [s]."""
        self._formed_at = math.inf
        """Since when parts are agreed on that take in what all ask for [s]."""

    def wait(self, now: float) -> None:
        """Nobody has anything to send yet."""
        self._until = now + TUNING.forming_time

    def lasts(self, now: float) -> bool:
        """Whether all other announcements have time."""
        return now < self._until

    def begins(self, now: float, team: Team) -> bool:
        """Whether a team that splits from the beginning has just begun, or may, as we have nothing large to send yet.

        Switched on 20 s before their applications ten robots reach 92 to 96 % of one decider so, and reached 60 to 69.
        """
        return (team.begins_split or not team.had_large) and self.lasts(now)

    def enters(self, now: float, *, splits: bool) -> bool:
        """Parts are in force now, or not; return whether they have just come to be."""
        entered = splits and not self._split
        if entered:
            self._until = now + TUNING.forming_time
        self._split = splits
        return entered

    def look(self, now: float, *, formed: bool, window: float) -> None:
        """See for how long parts have taken in what all ask for; the longest window takes so long [s]."""
        self._formed_at = min(self._formed_at, now) if formed else math.inf
        self.established |= now >= self._formed_at + window


class Meanwhile:
    """Whether a robot plans for all while its team splits the limits, as no message may fit an equal part.

    Eight and ten robots sent nothing for 1.8 to 4.1 s without that. From the agreement on a robot uses no more than it
    gives, and still counts what others send, for one window.
    """

    def __init__(self) -> None:
        self.plans = False
        self.confined = 1.0
        """The part of every limit that we use at most then."""

    def over(self) -> None:
        """The team has parts, or needs none."""
        self.plans, self.confined = False, 1.0

    def look(self, team: Team, agreement: Agreement, limits: tuple[Limit, ...], waiting: float) -> None:
        """Plan for all before parts are in force where samples are seldom and news soon, `waiting` for so long [s]."""
        may = team.splits and not (team.strict or team.quiet) and (team.undecided or team.seldom)
        soon = may and team.news_take(waiting) < TUNING.seldom_news * shortest_window(limits)
        self.plans = soon and not (agreement.newcomer and agreement.others_agreed)
        self.confined = agreement.entitled / UNIT if self.plans and agreement.formed else 1.0
