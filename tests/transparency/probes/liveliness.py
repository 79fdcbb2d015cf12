"""Liveliness tokens of applications on another robot."""

from tests.transparency.applications import Actor
from tests.transparency.feature import feature

GROUP = "Liveliness"


def came_and_went(team, key, token_key, app=None):
    """What subscribers on robots a (with and without history) and b, and a get, see of a token of robot b."""
    app = app or team.b.app
    watchers = {"far": team.a.app, "near": team.b.other}
    before = {where: watcher.liveliness_subscriber(key) for where, watcher in watchers.items()}
    team.settle()
    token = app.token(token_key)
    team.settle()
    late = {
        f"far, {what}": team.a.other.liveliness_subscriber(key, history=history)
        for what, history in (("late with history", True), ("late without", False))
    }
    found = team.a.app.tokens(key, count=1)
    team.settle()
    token.undeclare()
    team.settle()
    gone = team.a.app.tokens(key)
    seen = {where: watcher.heard() for where, watcher in (before | late).items()}
    return seen | {"get while": found, "get after": gone}


@feature(GROUP, "a token comes and goes")
def comes_and_goes(team):
    """What subscribers from before and after, with and without history, and gets are told."""
    return came_and_went(team, "alive/*", "alive/b")


@feature(GROUP, "tokens with verbatim chunks")
def verbatim(team):
    """Tokens `@alive/b`, `alive/@b` and one of a bridge for DDS, watched by name, by `@alive/*` and as bridges do."""
    seen = {}
    bridged = "@/b/@ros2_lv/MP/chatter/std_msgs§msg§String/:::"
    watched = (("@alive/b", "@alive/b"), ("@alive/*", "@alive/b"), ("alive/@b", "alive/@b"))
    for key, token in (*watched, ("@/*/@ros2_lv/**", bridged)):
        seen |= {f"{token} watched as {key}: {what}": told for what, told in came_and_went(team, key, token).items()}
    return seen


@feature(GROUP, "the same token twice")
def twice(team):
    """Two applications on two robots declare the same token: it goes when the second one goes."""
    watcher = team.a.app.liveliness_subscriber("alive/*")
    team.settle()
    tokens = [app.token("alive/both") for app in (team.b.app, team.c.app)]
    team.settle()
    seen = {}
    for number, token in enumerate(tokens):
        token.undeclare()
        team.settle()
        seen[f"after the end of {number + 1}"] = watcher.heard()
    return seen | {"get": team.a.app.tokens("alive/*")}


@feature(GROUP, "a token of the asker's own robot and of others")
def everywhere(team):
    """A get finds the tokens of all robots, and of its own application (which Zenoh may tell twice)."""
    for app in (team.a.app, team.a.other, team.b.app, team.c.app):
        app.token(f"alive/{app.name}")
    team.settle()
    askers = (team.a.app, team.c.app)
    found = {app.name: app.tokens("alive/*", count=4) for app in askers}
    return {f"get by {name}": sorted(set(keys)) for name, keys in found.items()}


@feature(GROUP, "session closed, process killed")
def killed(team):
    """The tokens of an application go when it closes its session, and when its process is killed."""
    watcher = team.a.app.liveliness_subscriber("alive/*")
    team.settle()
    team.b.open("brief").token("alive/brief")
    actor = Actor(team.b.place, team.names)
    team.b.open("doomed", actor).token("alive/doomed")
    team.settle()
    team.b.close("brief")
    watcher.came(last={"key": "alive/brief", "kind": "DELETE"})
    actor.kill()
    del team.b.apps["doomed"]
    watcher.came(last={"key": "alive/doomed", "kind": "DELETE"})
    return {"told": watcher.heard()}


@feature(GROUP, "many tokens")
def many(team):
    """200 tokens: all are found, all are told to a subscriber with history, all go."""
    tokens = [team.b.app.token(f"crowd/{number}") for number in range(200)]
    team.settle()
    watcher = team.a.app.liveliness_subscriber("crowd/*", history=True)
    found = team.a.app.tokens("crowd/*", count=len(tokens))
    watcher.came(count=len(tokens))
    for token in tokens:
        token.undeclare()
    team.settle()
    told = watcher.heard(count=2 * len(tokens))
    by_kind = {kind: {token["key"] for token in told if token["kind"] == kind} for kind in ("PUT", "DELETE")}
    return {"found": len(set(found)), "came": len(by_kind["PUT"]), "went": len(by_kind["DELETE"])}
