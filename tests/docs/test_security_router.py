"""A team whose robots meet at a router, which has the rules of `docs/guides/security.md`."""

import pytest

from proxy.bridge import keys
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, tag
from tests.daemons import Running
from tests.docs.certified import Team, meet, peers
from tests.proxy.nodes import answers, closing
from tests.waiting import wait_until

pytestmark = pytest.mark.full


@pytest.fixture
def team(tmp_path, stack):
    """Robots with certificates and without rules of their own."""
    return Team(tmp_path, stack)


def started(team, stack, name, endpoint, *options):
    """The daemon of a robot that meets others at a router."""
    where = ("--mesh.mode", "client", "--mesh.listen", "[]", "--mesh.connect", f'["{endpoint}"]')
    daemon = Running("--config", str(team.etc(name) / "sendworthy.toml"), *where, *options)
    stack.callback(daemon.end)
    daemon.wait_for("sendworthy ")
    return daemon


def test_behind_a_router_each_robot_speaks_for_itself_alone(team, stack):
    """Who has the certificate of r2 is r2 and nobody else, and gives no orders; an operator does."""
    endpoint = team.router()
    r1, ground = (started(team, stack, name, endpoint, "--fleet.mode", "true") for name in ("r1", "ground"))
    meet(r1, ground)
    session = closing(stack, team.session_at("r2", endpoint))
    wait_until(session.info.routers_zid, what="its link")
    zid = r1.status()["peers"][0]["zid"]
    held = [session.liveliness().declare_token(keys.alive("ground", "0badc0de"))]
    session.put(keys.digest("ground", tag(zid)), pack_digest(Digest("ground", tag(zid), 1e6, 10**6, 10**9)))
    assert list(answers(session, keys.fleet("r1", "mode"), payload=b"shadow")) == []
    held.append(session.liveliness().declare_token(keys.alive("r2", str(session.zid()))))
    wait_until(lambda: peers(r1) == {"ground", "r2"}, what="the insider under its own name")
    status = r1.status()
    assert status["mode"] == "enforce"
    assert status["refused"].keys() <= {"state:unknown"}  # a state may come before its robot's token
    operator = closing(stack, team.session_at("ground", endpoint))
    wait_until(lambda: list(answers(operator, keys.fleet("r1", "mode"), payload=b"shadow")), what="an answer")
    wait_until(lambda: r1.status()["mode"] == "shadow", what="what an operator orders")
