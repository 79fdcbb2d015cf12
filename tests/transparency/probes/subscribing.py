"""Which samples reach a subscriber: key expressions, and once each."""

from tests.transparency.feature import feature

GROUP = "Subscribing"


def heard_on_each_robot(team, expression, keys):
    """What applications on all robots hear of `expression` when one on robot a publishes on `keys`, in order."""
    listeners = {name: team.robots[name].other.subscriber(expression) for name in team.robots}
    team.settle()
    for key in keys:
        team.a.app.put(key, payload="x")
    team.flush()
    return {f"on robot {name}": listener.heard("key") for name, listener in listeners.items()}


@feature(GROUP, "key expressions")
def expressions(team):
    """Eight key expressions with and without wildcards: each subscriber hears every sample that matches, once."""
    keys = ["hear/a", "hear/a/b", "hear/a/b/c", "hear/x1/b", "hear/x2/b", "other/hear"]
    wanted = ("hear/a", "hear/*", "hear/**", "hear/*/b", "hear/x$*/b", "**/b/**", "*/hear", "**")
    listeners = {expression: team.b.app.subscriber(expression) for expression in wanted}
    team.settle()
    for key in keys:
        team.a.app.put(key, payload="x")
    team.flush()
    return {
        expression: [key for key in listener.heard("key") if not key.startswith(("settled", "flushed"))]
        for expression, listener in listeners.items()
    }


@feature(GROUP, "overlapping subscribers")
def overlapping(team):
    """Overlapping subscribers of one application and of two: each hears each sample once, from near and far."""
    apps = (team.b.app, team.b.app, team.b.other)
    listeners = [app.subscriber(key) for app, key in zip(apps, ("over/*", "over/a", "over/**"), strict=True)]
    team.settle()
    for robot in (team.a, team.b, team.c):
        robot.app.put("over/a", payload=robot.name)
    team.flush()
    return {f"subscriber {number}": sorted(each.heard("payload")) for number, each in enumerate(listeners)}


@feature(
    GROUP,
    "keys with verbatim chunks",
)
def verbatim(team):
    """`@hear/x`, `hear/@b/c` and `@a/@b`, subscribed by name."""
    seen = {}
    for key in ("@hear/x", "hear/@b/c", "@a/@b"):
        for where, heard in heard_on_each_robot(team, key, [key]).items():
            seen[f"{key} {where}"] = heard
    return seen


@feature(
    GROUP,
    "verbatim chunks and wildcards",
)
def verbatim_wildcards(team):
    """`@hear/**`, `hear/@b/*` and `hear/**`: a wildcard matches around a verbatim chunk, never it."""
    keys = ["@hear/x/y", "hear/@b/c", "hear/b/c"]
    seen = {}
    for expression in ("@hear/**", "hear/@b/*", "hear/**"):
        for where, heard in heard_on_each_robot(team, expression, keys).items():
            seen[f"{expression} {where}"] = heard
    return seen


@feature(GROUP, "undeclared subscriber")
def undeclared(team):
    """A subscriber that is taken back hears nothing more, one that stays does."""
    gone, stays = team.b.app.subscriber("leave/*"), team.b.other.subscriber("leave/**")
    team.settle()
    team.a.app.put("leave/a", payload="1")
    team.flush()
    first = gone.heard("payload")
    gone.undeclare()
    team.settle()
    team.a.app.put("leave/a", payload="2")
    team.flush()
    return {"the one that went": first, "the one that stayed": stays.heard("payload")}


@feature(GROUP, "subscriber that comes late")
def late(team):
    """A subscriber hears what is published once it is known, and nothing from before."""
    team.a.app.put("late/a", payload="before")
    team.flush()
    listener = team.b.app.subscriber("late/a")
    team.settle()
    team.a.app.put("late/a", payload="after")
    team.flush()
    return {"heard": listener.heard("payload")}


@feature(GROUP, "many subscribers")
def many(team):
    """200 subscribers, each of a key of its own."""
    keys = [f"many/{number}" for number in range(200)]
    listeners = {key: team.b.app.subscriber(key) for key in keys}
    team.settle()
    team.a.app.put_many(keys=keys, payloads=["x"])
    team.flush()
    return {"heard their sample": sum(listener.heard("key") == [key] for key, listener in listeners.items())}
