"""Daemons with credentials on the mesh talk to their like, and to nobody else."""

import json
import subprocess

import pytest

from tests.system.network import Network
from tests.transparency.arrangements import ROBOTS, SENDWORTHY, Team, serve
from tests.waiting import wait_until

pytestmark = pytest.mark.system

TLS = """listen = ["tls/0.0.0.0:7500"]
[mesh.zenoh.transport.link.tls]
enable_mtls = true
root_ca_certificate = "{folder}/ca.pem"
listen_certificate = "{folder}/{name}.pem"
listen_private_key = "{folder}/{name}.key"
connect_certificate = "{folder}/{name}.pem"
connect_private_key = "{folder}/{name}.key"
"""
USER = """[mesh.zenoh.transport.auth.usrpwd]
user = "{name}"
password = "{password}"
dictionary_file = "{dictionary}"
"""


def openssl(folder, *arguments):
    """Run it in `folder`."""
    subprocess.run(["openssl", *arguments], cwd=folder, check=True, capture_output=True)


def certify(folder, name, address, authority):
    """Make a key and a certificate for a robot, signed by an authority that is made at its first use."""
    curve = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    if not (folder / f"{authority}.pem").exists():
        files = ("-keyout", f"{authority}.key", "-out", f"{authority}.pem")
        openssl(folder, "req", "-x509", *curve, "-subj", f"/CN={authority}", "-days", "2", *files)
    signed = ("-CA", f"{authority}.pem", "-CAkey", f"{authority}.key", "-days", "2")
    names = ("-subj", f"/CN={name}", "-addext", f"subjectAltName=IP:{address}")
    # The authority's own extensions must not be taken over: Zenoh accepts no authority as an end of a link.
    ends = ("-addext", "basicConstraints=critical,CA:FALSE")
    openssl(folder, "req", "-x509", *curve, *signed, *names, *ends, "-keyout", f"{name}.key", "-out", f"{name}.pem")


def with_tls(folder, place):
    """A certificate each; that of c is of another authority."""
    name = place.host.name
    certify(folder, name, place.host.address, "other" if name == "c" else "ca")
    return TLS.format(folder=folder, name=name)


def with_passwords(folder, place):
    """A password each; c knows one that the others do not know."""
    name = place.host.name
    secret = "guess" if name == "c" else "secret"
    dictionary = folder / f"{secret}s"
    dictionary.write_text("".join(f"{robot}:{secret} of {robot}\n" for robot in ROBOTS))
    return USER.format(dictionary=dictionary, name=name, password=f"{secret} of {name}")


@pytest.fixture
def team(tmp_path, place):
    """Three robots without anything that serves them yet."""
    network = Network(place, "mesh")
    team = Team(network, tmp_path)
    yield team
    for log in tmp_path.glob("*/log"):
        print(f"--- {log.parent.name}\n{log.read_text()}")
    team.close()
    network.close()


@pytest.mark.parametrize("credentials", [with_tls, with_passwords])
def test_only_who_has_credentials_takes_part(team, tmp_path, credentials):
    """Samples, queries and tokens cross between a and b; c finds them, and hears and reaches nobody."""
    logs = {name: serve(team, team.place(name), credentials(tmp_path, team.place(name))) for name in ROBOTS}
    for name, log in logs.items():
        wait_until(lambda log=log: "sendworthy: sendworthy " in log.read_text(), 20.0, f"start of {name}")
        team.add(name)
        team.robots[name].open("app")
    wait_until(lambda: peers(team.a) == {"b"} and peers(team.b) == {"a"}, 20.0, "meeting of a and b")
    members = [team.a, team.b]
    heard = {name: robot.app.subscriber("secret/*") for name, robot in team.robots.items()}
    answers = [{"reply": {"payload": "answer"}}]
    for robot in members:
        robot.app.queryable(f"secret/{robot.name}", answers=answers)
        robot.app.token(f"secret/{robot.name}")
    wait_until(lambda: tokens(team.a) == tokens(team.b) == {"secret/a", "secret/b"}, what="tokens of both")
    for robot in team.robots.values():
        robot.app.put(f"secret/{robot.name}", payload="x", congestion_control="BLOCK")
    assert team.a.app.get("secret/b", timeout=5.0).heard("payload", over=True) == ["answer"]
    for robot in members:
        assert heard[robot.name].came(count=2)
        assert sorted(heard[robot.name].heard("key")) == ["secret/a", "secret/b"]
    assert heard["c"].heard("key") == ["secret/c"]
    assert team.c.app.get("secret/*", timeout=5.0).heard(over=True) == []
    assert tokens(team.c) == set()
    assert peers(team.c) == set()


def peers(robot):
    """The robots that a daemon knows."""
    asked = robot.place.host.run(*SENDWORTHY, "status", "--json")
    assert asked.returncode == 0, asked.stderr
    return {peer["robot"] for peer in json.loads(asked.stdout)["peers"]}


def tokens(robot):
    """The tokens that an application finds; Zenoh may tell its own twice."""
    return set(robot.app.tokens("secret/*"))
