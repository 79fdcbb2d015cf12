"""What publishers and queriers are told about those who match."""

import time

from tests.transparency.feature import feature

GROUP = "Matching"
_SOON = 1.0
"""How long a change that may never come has to come [s]."""
_PAUSE = 0.01


def told(team, asker, declare):
    """Matching status before, while and after `declare` gives a match on robot b, and what a listener is told."""
    listener = asker.listen()
    team.settle()
    seen = {"status before": asker.matching()}
    match = declare()
    team.settle()
    seen["status while"] = asker.matching()
    match.undeclare()
    team.settle()
    seen["status after"] = ceases(asker)
    listener.came(count=2, timeout=_SOON)
    heard = listener.heard("matching")
    listener.undeclare()
    return seen | {"told": heard}


def ceases(asker):
    """Whether `asker` still matches when it has had time to learn of an end."""
    end = time.monotonic() + _SOON
    while (matching := asker.matching()) and time.monotonic() < end:
        time.sleep(_PAUSE)
    return matching


@feature(
    GROUP,
    "publisher and a subscriber on another robot",
)
def publisher(team):
    """Matching status and listener of a publisher before, while and after a subscriber matches on another robot."""
    return told(team, team.a.app.publisher("match/pub"), lambda: team.b.app.subscriber("match/*"))


@feature(
    GROUP,
    "publisher and a subscriber on its robot",
)
def publisher_near(team):
    """The same with a subscriber on the same robot."""
    return told(team, team.a.app.publisher("match/pub"), lambda: team.a.other.subscriber("match/*"))


@feature(
    GROUP,
    "publisher and a subscriber that does not match",
)
def publisher_else(team):
    """The same with a subscriber of another key on another robot."""
    return told(team, team.a.app.publisher("match/pub"), lambda: team.b.app.subscriber("match/other"))


@feature(
    GROUP,
    "publisher with a verbatim key",
)
def publisher_verbatim(team):
    """The same with key `match/@pub`."""
    return told(team, team.a.app.publisher("match/@pub"), lambda: team.b.app.subscriber("match/@pub"))


@feature(GROUP, "publisher that comes after the subscriber")
def publisher_late(team):
    """A publisher that is declared when there is a subscriber already on another robot."""
    team.b.app.subscriber("match/*")
    team.settle()
    publisher = team.a.app.publisher("match/pub")
    listener = publisher.listen()
    team.settle()
    return {"status": publisher.matching(), "told": listener.heard("matching", count=1, timeout=_SOON)}


@feature(GROUP, "querier and a queryable on another robot")
def querier(team):
    """Matching status and listener of a querier before, while and after a queryable matches on another robot."""
    return told(team, team.a.app.querier("match/ask"), lambda: team.b.app.queryable("match/*", answers=[]))


@feature(GROUP, "querier of complete answers only")
def querier_complete(team):
    """The same for target ALL_COMPLETE, with a queryable that is not complete and with one that is."""
    askers = [team.a.app.querier("match/ask", target="ALL_COMPLETE") for _ in range(2)]
    first = told(team, askers[0], lambda: team.b.app.queryable("match/*", answers=[]))
    askers[0].undeclare()
    second = told(team, askers[1], lambda: team.b.app.queryable("match/**", answers=[], complete=True))
    return {f"incomplete: {what}": seen for what, seen in first.items()} | {
        f"complete: {what}": seen for what, seen in second.items()
    }
