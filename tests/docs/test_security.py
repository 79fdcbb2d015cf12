"""`docs/guides/security.md`, step by step as it stands there, and those whom it shall keep out."""

import pytest
import zenoh

from proxy import exit_codes
from proxy.bridge import keys
from proxy.cli import main
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, tag
from tests.daemons import specs_file
from tests.docs.certified import PAGE, blocks, dialling, meet, peers
from tests.proxy.counting import Counting
from tests.proxy.nodes import Heard, answers, closing, plain_session, wait_matching
from tests.waiting import wait_until

pytestmark = pytest.mark.full
CONFIDENTIAL = "what only the team may read"


@pytest.fixture(scope="module")
def pair(team):
    """The daemons of r1 and ground; r2 is left to whoever has its certificate."""
    r1 = team.start("r1")
    ground = team.start("ground", "r1")
    meet(r1, ground)
    return r1, ground


@pytest.fixture
def apps(pair, stack):
    """An application at r1 and one at ground."""
    return [closing(stack, plain_session("client", connect=(daemon.endpoint,))) for daemon in pair]


def strangers(team, tmp_path):
    """Ways to try to link without a certificate of the team, each with its protocol and options."""
    tls = {"root_ca_certificate": str(team.made / "ca.pem")}
    team.certify(tmp_path)  # as ours was: the names are the same, the authority is another one
    made = tmp_path / "team"
    own = {"enable_mtls": True, "connect_certificate": str(made / "ground.pem")}
    own["connect_private_key"] = str(made / "ground.key")
    return {
        "a plain link": ("tcp", {}),
        "no certificate": ("tls", {"link": {"tls": tls}}),
        "a certificate of its own": ("tls", {"link": {"tls": tls | own}}),
    }


def overheard(session, expression):
    """What others publish, as far as a session hears it."""
    found = []
    handler = zenoh.handlers.Callback(found.append, indirect=False)
    session.declare_subscriber(expression, handler, allowed_origin=zenoh.Locality.REMOTE)
    return found


def test_a_stranger_sees_and_changes_nothing(team, pair, apps, stack, tmp_path):
    """Whichever way it tries; meanwhile the team works."""
    r1, _ = pair
    before = r1.status()
    sessions = []
    for protocol, transport in strangers(team, tmp_path).values():
        relay = stack.enter_context(Counting(team.endpoints["r1"], taps=(tried := bytearray())))
        session = closing(stack, dialling([relay.endpoint.replace("tcp/", f"{protocol}/")], transport))
        sessions.append((session, [overheard(session, each) for each in ("**", "@sendworthy/**")]))
        wait_until(lambda tried=tried: tried, what="an attempt to link")
        session.liveliness().declare_token(keys.alive("ground", str(session.zid())))
    told = Digest("ground", tag(before["peers"][0]["zid"]), 1e6, 1, 1)
    heard = Heard(apps[1], "data/**")
    wait_matching(apps[0], "data/x")
    for round_ in range(20):
        for session, _ in sessions:
            session.put("data/x", "forged")
            session.put(keys.digest("ground", told.tag), pack_digest(told))
            list(session.get(keys.fleet("r1", "mode"), payload="shadow", timeout=0.2))
        apps[0].put("data/x", f"{CONFIDENTIAL} {round_}", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: heard.payloads[-1:] == [f"{CONFIDENTIAL} 19"], what="what the team says")
    assert heard.payloads == [f"{CONFIDENTIAL} {round_}" for round_ in range(20)]
    for session, all_heard in sessions:
        assert not session.info.peers_zid()
        assert all_heard == [[], []]
    after = r1.status()
    assert (peers(r1), after["mode"], after["refused"]) == ({"ground"}, "enforce", before["refused"])


def test_what_robots_say_cannot_be_read_on_its_way(team, pair, stack):
    """The same sample is there for all to read where the link is plain."""
    secured, plain = bytearray(), bytearray()
    relay = stack.enter_context(Counting(team.endpoints["r1"], taps=secured))
    r2 = team.start("r2", via=relay.endpoint.replace("tcp/", "tls/"))
    local = stack.enter_context(Counting(r2.endpoint, taps=plain))
    here = closing(stack, plain_session("client", connect=(local.endpoint,)))
    r1, _ = pair
    heard = Heard(closing(stack, plain_session("client", connect=(r1.endpoint,))), "data/y")
    wait_until(lambda: here.put("data/y", CONFIDENTIAL) or heard.payloads, what="a sample")
    assert CONFIDENTIAL.encode() in plain
    assert len(secured) > 1000
    assert CONFIDENTIAL.encode() not in secured
    r2.end()


def test_what_applications_say_crosses(apps):
    """Samples, queries and tokens, also those of advanced publishers and of ROS 2."""
    here, there = apps
    heard = [Heard(there, each) for each in ("data/z", "cam/@adv/**")]
    wait_until(lambda: here.put("data/z", "x") or heard[0].payloads, what="a sample")
    wait_until(lambda: here.put("cam/@adv/pub/1", "x") or heard[1].payloads, what="one of an advanced publisher")
    here.declare_queryable("service", lambda query: query.reply("service", "yes"))
    wait_until(lambda: "yes" in answers(there, "service"), what="an answer")
    tokens = ["alive/here", "cam/@adv/pub/1", "@ros2_lv/0/node"]
    held = [here.liveliness().declare_token(each) for each in tokens]
    for key in tokens:
        wait_until(lambda key=key: [r for r in there.liveliness().get(key, timeout=5.0) if r.ok], what=f"token {key}")
    for token in held:
        token.undeclare()


class Insider:
    """A program that has the certificate of r2, and hears what daemons tell."""

    def __init__(self, team, pair):
        self.session = team.session("r2", "r1", "ground")
        self.r1, self.ground = pair
        self.zids = {
            name: daemon.status()["daemon"]["sessions"]["mesh"]
            for name, daemon in zip(("r1", "ground"), pair, strict=True)
        }
        self.digests = Heard(self.session, keys.ALL_DIGESTS)
        wait_until(lambda: len(self.session.info.peers_zid()) == 2, what="its links")

    def digest_of_ground(self):
        """One that it heard."""
        mine = keys.digest("ground", tag(self.zids["ground"]))
        wait_until(lambda: any(str(each.key_expr) == mine for each in self.digests.samples), what="a digest of ground")
        return mine, next(each.payload.to_bytes() for each in self.digests.samples if str(each.key_expr) == mine)


@pytest.fixture
def insider(team, pair):
    made = Insider(team, pair)
    yield made
    made.session.close()


def test_a_robot_speaks_for_itself_alone(insider, pair):
    """Neither forged nor repeated digests, states, answers and tokens of another robot reach anybody."""
    r1, ground = pair
    before = r1.status()["refused"]
    key, repeated = insider.digest_of_ground()
    forged = pack_digest(Digest("ground", tag(insider.zids["ground"]), 1e6, 10**6, 10**9))
    session = insider.session
    false = [
        session.liveliness().declare_token(keys.alive("ground", "0badc0de")),
        session.liveliness().declare_token(keys.alive("r2", insider.zids["ground"])),
        session.declare_queryable(keys.state("ground", tag(insider.zids["ground"])), lambda _: None),
    ]
    own = keys.alive("r2", str(session.zid()))
    token = session.liveliness().declare_token(own)
    for payload in (repeated, forged):
        session.put(key, payload)
        session.put(f"@sendworthy/*/digest/{tag(insider.zids['ground'])}", payload)
        session.put(keys.state("ground", tag(insider.zids["ground"])), payload)
        session.put(keys.digest("r2", tag(insider.zids["ground"])), payload)
    wait_until(lambda: peers(r1) == {"ground", "r2"}, what="the insider under its own name")
    wait_until(lambda: r1.status()["refused"].get("token:forged"), what="what it says of ground's session")
    refused = r1.status()["refused"]
    # Under its own name with the session of another robot: that is all that reaches anybody.
    assert {kind: count - before.get(kind, 0) for kind, count in refused.items() if count != before.get(kind)} == {
        "token:forged": 1,
        "digest:forged": 1,
        "digest:old": 1,
    }
    for each in false:
        each.undeclare()
    token.undeclare()
    wait_until(lambda: peers(r1) == {"ground"}, what="its end")
    assert ground.status()["counts"]["conserved"]


def test_who_is_not_in_the_list_takes_no_part(team, pair, stack):
    """Whatever its certificate: it is linked, and nothing it says is taken, nor is anything told to it."""
    r1, ground = pair
    session = closing(stack, team.newcomer("r9", "r1", "ground"))
    wait_until(lambda: len(session.info.peers_zid()) == 2, what="its links")
    heard = [overheard(session, each) for each in ("**", keys.ALL_DIGESTS, keys.ALL_STATES)]
    session.liveliness().declare_token(keys.alive("r9", str(session.zid())))
    apps = [closing(stack, plain_session("client", connect=(daemon.endpoint,))) for daemon in pair]
    at_ground = Heard(apps[1], "data/w")
    wait_matching(apps[0], "data/w")
    session.put("data/w", "forged")
    wait_until(lambda: apps[0].put("data/w", CONFIDENTIAL) or at_ground.payloads, what="what the team says")
    assert set(at_ground.payloads) == {CONFIDENTIAL}
    assert heard == [[], [], []]
    assert peers(r1) == {"ground"}
    assert peers(ground) == {"r1"}


def test_only_an_operator_who_knows_the_token_orders(team, pair, insider, capsys, tmp_path):
    """A robot with a certificate changes neither modes nor specs, with the token or without it."""
    r1, ground = pair
    token = str(team.made / "fleet.token")
    for payload in (b"shadow", b"pass"):
        assert list(answers(insider.session, keys.fleet("r1", "mode"), payload=payload)) == []
    assert list(answers(insider.session, keys.fleet("*", "challenge"), payload=b"?")) == []
    order = ["mode", "shadow", "--fleet", "--connect", ground.endpoint]
    assert main(order) == exit_codes.FAILED
    assert "r1: it takes the token of the team" in capsys.readouterr().err
    assert r1.status()["mode"] == "enforce"
    assert main([*order, "--token-file", token]) == exit_codes.OK
    assert [daemon.status()["mode"] for daemon in pair] == ["shadow", "shadow"]
    # r1 is no operator: ground does not even hear it.
    assert main([*order[:3], "--connect", r1.endpoint, "--token-file", token]) == exit_codes.FAILED
    assert "ground: no answer" in capsys.readouterr().err
    push = ["push", str(specs_file(tmp_path)), "--connect", ground.endpoint]
    assert main(push) == exit_codes.FAILED
    before = r1.status()["specs"]
    assert main([*push, "--token-file", token]) == exit_codes.OK
    assert r1.status()["specs"] != before
    assert main(["mode", "enforce", *order[2:], "--token-file", token]) == exit_codes.OK


def test_the_commands_of_operators_are_those_of_the_command_line():
    """What the page has operators type is what the test above does."""
    assert PAGE.read_text().count("```sh\n") == 6
    _, typed = blocks("3.", "sh")
    assert typed.splitlines() == [
        "sendworthy push specs.d --token-file fleet.token",
        "sendworthy mode shadow --fleet --token-file fleet.token",
    ]
