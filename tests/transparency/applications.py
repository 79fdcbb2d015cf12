"""The test's end of the applications: what a probe holds in its hands.

An `App` is one application on a robot; what it declares is a `Thing`. Both do whatever `actor.Actor` does: each of its
methods is a method here. What is heard comes with ids replaced by names, so that two runs tell the same.
"""

import itertools
import json
import re
import subprocess
import sys
import time

PATIENCE = 10.0
"""How long a probe waits for what ought to come [s]."""
_PROGRAM = (sys.executable, "-m", "tests.transparency.actor")
_THINGS = {
    "advanced_publisher",
    "advanced_subscriber",
    "ask",
    "detect_publishers",
    "get",
    "liveliness_get",
    "liveliness_subscriber",
    "matching_listener",
    "miss_listener",
    "publisher",
    "querier",
    "queryable",
    "scout",
    "subscriber",
    "token",
}
"""What makes something with a name."""


class Refused(Exception):  # noqa: N818 - it is what Zenoh said to the application
    """Zenoh refused what an application asked."""


class Actor:
    """The process of `actor.py` on a host."""

    def __init__(self, host, names):
        self.names = names
        self.numbers = itertools.count(1)
        self._process = host.start(*_PROGRAM, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def do(self, what, **words):
        """Let it do something; return its answer. Raises Refused."""
        self._process.stdin.write(json.dumps({"do": what} | words) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        assert line, "the applications ended early"
        answer = json.loads(line)
        if answer is not None and "error" in answer:
            raise Refused(answer["error"])
        return answer

    def kill(self):
        """End it as the kernel does, without a word."""
        self._process.kill()
        self._process.communicate()


class App:
    """One application, a Zenoh session of its own."""

    def __init__(self, actor, name, config):
        self.name = name
        self.actor = actor
        self.namespace = config.get("namespace")
        self.zid = actor.do("open", app=name, config=config)["zid"]
        actor.names.sessions[self.zid] = name

    def tokens(self, key, count=0):
        """The keys of the tokens that it finds, once there are `count`.

        Zenoh's answer may end before it is whole, behind one router of its own, too, most of all right after a
        subscriber of tokens was declared: with fewer than `count` it is asked again, for a while.
        """
        until = time.monotonic() + PATIENCE
        found = self.liveliness_get(key).heard("key", over=True)
        while len(set(found)) < count and time.monotonic() < until:
            found = self.liveliness_get(key).heard("key", over=True)
        return found

    def __getattr__(self, what):
        """Let it do `what`: the first word is a key, or whatever the operation is about."""

        def do(*about, label=None, **words):
            if about:
                words[_ABOUT.get(what, "key")] = about[0]
            if what not in _THINGS:
                return self.actor.do(what, app=self.name, **words)
            return Thing(self, what, label or f"{what} of {self.name}", words)

        return do


class Thing:
    """Something that an application has declared, or the replies to what it asked."""

    def __init__(self, app, what, label, words):
        self._app = app
        self.name = f"{label} {next(app.actor.numbers)}"
        made = app.actor.do(what, name=self.name, **(words if what in _OF_ANOTHER else {"app": app.name} | words))
        if made and "id" in made:
            app.actor.names.entities[tuple(made["id"])] = label

    def heard(self, *fields, raw=False, timeout=PATIENCE, **until):
        """Wait `until` enough was heard (`count`, `last`, `over`) or the time is up.

        Return all that was heard; only the `fields` that are named, and the value alone of one field.
        """
        items = self._app.actor.do("heard", name=self.name, timeout=timeout, **until)["items"]
        items = items if raw else [self._app.actor.names.in_words(item) for item in items]
        if len(fields) == 1:
            return [item.get(fields[0]) for item in items]
        return [{field: item.get(field) for field in fields} for item in items] if fields else items

    def came(self, timeout=PATIENCE, **until):
        """Wait `until` enough was heard; whether it was in time."""
        return self._app.actor.do("heard", name=self.name, timeout=timeout, **until)["came"]

    def publish(self, payload=None, **attributes):
        """Publish with this publisher; without a payload, a delete."""
        self._app.actor.do("publish", app=self._app.name, name=self.name, payload=payload, **attributes)

    def matching(self):
        """Whether anybody matches now."""
        return self._app.actor.do("matching", name=self.name)["matching"]

    def listen(self, what="matching_listener"):
        """Declare a listener on this."""
        return getattr(self._app, what)(of=self.name)

    def ask(self, **options):
        """Ask with this querier."""
        return self._app.ask(of=self.name, **options)

    def finish(self, *answers):
        """Answer and end the queries that this queryable holds."""
        self._app.actor.do("finish", app=self._app.name, name=self.name, answers=answers)

    def undeclare(self):
        """Take it back."""
        self._app.actor.do("undeclare", name=self.name)


_ZID = re.compile("[0-9a-f]{24,32}")
_ABOUT = {"get": "selector", "scout": "kinds"}
_OF_ANOTHER = {"matching_listener", "miss_listener", "detect_publishers", "scout"}


class Names:
    """Words for the ids of a run."""

    def __init__(self):
        self.sessions = {}
        self.entities = {}

    def session(self, zid):
        """The name of a session: an application, "router" for what applications see as such, or "another"."""
        return self.sessions.get(zid, "another")

    def entity(self, identity):
        """The name of what was declared, or of its session."""
        return self.entities.get(tuple(identity), f"something of {self.session(identity[0])}")

    def in_words(self, item):
        """What was heard, without numbers that differ from run to run."""
        item = {key: value for key, value in item.items() if key != "after"}
        if item.get("stamp"):
            item["stamp"] = self.session(item["stamp"][1])
        if item.get("source"):
            *identity, number = item["source"] if len(item["source"]) == 3 else (*item["source"], None)
            item["source"] = self.entity(identity) if number is None else [self.entity(identity), number]
        if item.get("replier"):
            item["replier"] = self.entity(item["replier"])
        if "key" in item:
            item["key"] = self._in_key(item["key"])
        if "zid" in item:
            item["zid"] = self.session(item["zid"])
        return item

    def _in_key(self, key):
        """A key with names for the ids of sessions and of what they have declared."""
        chunks = key.split("/")
        for place, chunk in enumerate(chunks):
            if chunk in self.sessions or _ZID.fullmatch(chunk):
                chunks[place] = self.session(chunk)
                if chunks[place + 1 : place + 2] and chunks[place + 1].isdecimal():
                    chunks[place + 1] = "0"
        return "/".join(chunks)
