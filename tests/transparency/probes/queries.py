"""Queries between applications on different robots: what is asked, what is answered, and how it ends."""

from tests.transparency.feature import Limit, feature

GROUP = "Queries"
_ENDLESS = 60.0
"""The timeout of queries that must end by something else [s]."""


def asked(team, *answers, key="ask/it", selector="ask/it", **options):
    """What a queryable on robot b hears of a query from robot a, and what comes back."""
    queryable = team.b.app.queryable(key, answers=answers, label="queryable")
    team.settle()
    replies = team.a.app.get(selector, timeout=_ENDLESS, **options)
    over = replies.came(over=True)
    return {"over": over, "replies": replies.heard(), "asked": queryable.heard()}


@feature(GROUP, "what a queryable hears")
def query(team):
    """Key, parameters, payload, encoding and attachment of a query."""
    parts = {"payload": "what", "encoding": "text/plain;en", "attachment": "how"}
    (whole,) = asked(team, selector="ask/*?a=1;b=two words;_anyke;c", **parts)["asked"]
    bare = asked(team)["asked"]
    return {"parameters": whole.pop("parameters"), "a query with everything": whole, "a bare query": bare}


@feature(GROUP, "what an asker hears")
def replies(team):
    """A reply with encoding, attachment, express and timestamp; several replies; a delete; an error."""
    answers = (
        {"reply": {"payload": "1", "encoding": "text/csv;s", "attachment": "how", "express": True, "timestamp": 0}},
        {"reply": {"payload": "2", "key": "ask/other"}},
        {"delete": {"key": "ask/gone", "attachment": "why"}},
        {"error": {"payload": "no", "encoding": "text/plain"}},
    )
    seen = asked(team, *answers, key="ask/**", selector="ask/**", consolidation="NONE")
    kinds = ("reply", "second reply", "delete", "error")
    return {kind: _but(reply, "replier") for kind, reply in zip(kinds, seen["replies"], strict=True)}


@feature(GROUP, "no answer")
def nothing(team):
    """A queryable that answers nothing, and a key that has no queryable: the query ends at once."""
    seen = asked(team)
    nobody = team.a.app.get("ask/nobody", timeout=_ENDLESS)
    return {"no reply": [seen["over"], seen["replies"]], "nobody": [nobody.came(over=True), nobody.heard()]}


@feature(GROUP, "replies on other keys")
def other_keys(team):
    """A reply whose key does not match the query: refused, unless the asker accepts any key."""
    answer = {"reply": {"key": "elsewhere/it", "payload": "x"}}
    seen = {}
    for accepted in ("MATCHING_QUERY", "ANY"):
        found = asked(team, answer, key=f"ask/{accepted}", selector=f"ask/{accepted}", accept_replies=accepted)
        seen[f"{accepted} over"] = found["over"]
        seen[f"{accepted}, as the queryable sees"] = [query.get("accepts") for query in found["asked"][:1]]
        seen[f"{accepted} refused to the queryable"] = any("refused" in query for query in found["asked"])
        seen[f"{accepted} replies"] = [(reply.get("key"), reply["payload"]) for reply in found["replies"]]
    return seen


@feature(GROUP, "quality of replies")
def quality(team):
    """A reply has the priority and congestion control of its query."""
    seen = {}
    for priority, control in (("DATA", "BLOCK"), ("REAL_TIME", "DROP"), ("BACKGROUND", "BLOCK")):
        key, options = f"ask/{priority}", {"priority": priority, "congestion_control": control}
        (reply,) = asked(team, {"reply": {"payload": "x"}}, key=key, selector=key, **options)["replies"]
        seen[f"{priority}, {control}"] = [reply["priority"], reply["congestion"], reply["express"]]
    return seen


@feature(GROUP, "source info of a query")
def source(team):
    """Who asks and the number it gave, as the queryable sees it."""
    publisher = team.a.app.publisher("ask/me", label="asker")
    return {"source": [query["source"] for query in asked(team, source=[publisher.name, 3])["asked"]]}


@feature(
    GROUP,
    "replier id",
    Limit(
        "A daemon answers for the queryables of other robots, and Zenoh lets nobody answer under another's id.",
        {"replier": ("queryable", "something of another")},
    ),
)
def replier(team):
    """Who answered, as the asker sees it."""
    (reply,) = asked(team, {"reply": {"payload": "x"}})["replies"]
    return {"replier": reply["replier"]}


@feature(
    GROUP,
    "timestamps on the way of a query",
    Limit(
        "Zenoh has no way to ask on with the stamps that a query came with, so they end at the daemon.",
        {"stack": ([["SEND", "ROUTE", "ROUTE", "ROUTE", "ROUTE", "RECEIVE"]], [None])},
    ),
)
def instrumented(team):
    """Timestamp instrumentation: at which points a query is stamped when it asks for it."""
    return {"stack": [query["stack"] for query in asked(team, instrumented=True)["asked"]]}


@feature(GROUP, "many replies, large replies")
def many(team):
    """500 replies on keys of their own, and one of 1 MB."""
    answers = [{"reply": {"key": f"ask/{number}", "payload": str(number)}} for number in range(500)]
    seen = asked(team, *answers, key="ask/*", selector="ask/*")
    large = asked(team, {"reply": {"payload": "x" * 1_000_000}}, key="ask/large/it", selector="ask/large/it")
    return {
        "right replies": sum(reply["key"] == f"ask/{reply['payload']}" for reply in seen["replies"]),
        "large": [reply["payload"] for reply in large["replies"]],
    }


@feature(
    GROUP,
    "keys with verbatim chunks",
)
def verbatim(team):
    """Queryables of `@ask/it`, `ask/@it` and `ask/@it/**`."""
    pairs = (("@ask/it", "@ask/it"), ("ask/@it", "ask/@it"), ("ask/@it/**", "ask/@it/a"))
    answer = {"reply": {"payload": "x"}}
    return {key: len(asked(team, answer, key=key, selector=selector)["replies"]) for key, selector in pairs}


@feature(GROUP, "querier")
def querier(team):
    """A declared querier: parameters, payload, encoding and attachment; several queries of it."""
    queryable = team.b.app.queryable("ask/it", answers=[{"reply": {"payload": "x"}}])
    asker = team.a.app.querier("ask/*", target="ALL", consolidation="NONE", timeout=_ENDLESS, priority="DATA_HIGH")
    team.settle()
    told = ({}, {"parameters": "a=1", "payload": "what", "encoding": "text/csv", "attachment": "how"})
    replies = [asker.ask(**options).heard("key", "payload", "priority", over=True) for options in told]
    return {"asked": queryable.heard(), "replies": replies}


@feature(GROUP, "a queryable that answers late")
def late(team):
    """A query that is held open: answered and ended later; nothing comes before."""
    queryable = team.b.app.queryable("ask/it", answers=[{"reply": {"payload": "at once"}}, {"hold": {}}])
    team.settle()
    replies = team.a.app.get("ask/it", timeout=_ENDLESS, consolidation="NONE")
    replies.came(count=1)
    queryable.came(count=1)
    before = [replies.came(over=True, timeout=0.1), replies.heard("payload")]
    queryable.finish({"reply": {"payload": "late"}})
    return {"before": before, "after": [replies.came(over=True), replies.heard("payload")]}


@feature(GROUP, "the asker's timeout")
def timeout(team):
    """A query that nobody ends: after the asker's own timeout of 0.3 s it is over, with what came until then."""
    queryable = team.b.app.queryable("ask/it", answers=[{"reply": {"payload": "at once"}}, {"hold": {}}])
    team.settle()
    replies = team.a.app.get("ask/it", timeout=0.3, consolidation="NONE")
    seen = {"over": replies.came(over=True), "replies": _each_once(replies.heard("kind", "payload"))}
    queryable.finish({"reply": {"payload": "too late"}})
    return seen | {"after": _each_once(replies.heard("kind", "payload"))}


@feature(GROUP, "a queryable that dies")
def dies(team):
    """A query whose queryable goes while it is open ends then, not with its timeout."""
    ends = {}
    for how in ("undeclared", "session closed"):
        app = team.b.open("brief")
        queryable = app.queryable("ask/it", answers=[{"hold": {}}])
        team.settle()
        replies = team.a.app.get("ask/it", timeout=_ENDLESS)
        queryable.came(count=1)
        if how == "undeclared":
            queryable.undeclare()
        team.b.close("brief")
        ends[how] = [replies.came(over=True, timeout=3.0), replies.heard("kind", "payload")]
    return ends


@feature(GROUP, "a query that is cancelled")
def cancelled(team):
    """The asker cancels: the query is over at once."""
    queryable = team.b.app.queryable("ask/it", answers=[{"hold": {}}])
    team.settle()
    replies = team.a.app.get("ask/it", timeout=_ENDLESS, cancellation="token")
    queryable.came(count=1)
    team.a.actor.do("cancel", name="token")
    return {"over": replies.came(over=True), "replies": replies.heard()}


@feature(GROUP, "100 queries at once")
def at_once(team):
    """All are answered, each with its own answer."""
    team.b.app.queryable("ask/*", answers=[{"reply": {"payload": "x"}}])
    team.settle()
    all_replies = [team.a.app.get(f"ask/{number}", timeout=_ENDLESS) for number in range(100)]
    right = [replies.heard("key", over=True) == [f"ask/{number}"] for number, replies in enumerate(all_replies)]
    return {"answered": sum(right)}


def _each_once(items):
    """What was heard, in order; the router and the session may both tell of a timeout."""
    return [item for number, item in enumerate(items) if item not in items[:number]]


def _but(item, *fields):
    """Without some fields."""
    return {key: value for key, value in item.items() if key not in fields}
