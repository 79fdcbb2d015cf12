"""What a daemon tells of itself and of others."""

import pytest

from proxy.bridge.lookout import CURE
from proxy.config import AppConfig, Config, MeshConfig
from proxy.doctor.finding import State
from proxy.doctor.team import alone, team
from proxy.version import version

HERE = "tcp/127.0.0.1:17447"
PLACE = "tcp/127.0.0.1:17850"
CONFIG = Config(robot="r1", app=AppConfig(listen=(HERE,)), mesh=MeshConfig(listen=()))


def peer(robot, **values):
    """Another robot, as far as the doctor asks."""
    return {"robot": robot, "zid": f"zid of {robot}", "version": version(), "takes_part": True} | values


def status(*peers, warnings=(), links=(), **values):
    """A status, as far as the doctor asks."""
    told = {"app": [HERE], "mesh": [], "links": [{"zid": zid, "destination": place} for zid, place in links]}
    base = {"robot": "r1", "mode": "enforce", "version": version(), "daemon": told}
    return base | {"peers": list(peers), "warnings": list(warnings)} | values


def look(told, config=CONFIG):
    """Return what is no finding by check, and the findings."""
    found = list(team(told, config))
    fine = {each.check: each.text for each in found if each.state == State.FINE}
    return fine, [(each.check, each.text) for each in found if each.state == State.FINDING]


def test_a_daemon_alone_is_fine():
    """Nobody else is known."""
    assert look(status()) == (
        {
            "daemon": "robot r1 in mode enforce warns of nothing",
            "applications": "none is seen around the daemon",
            "other robots": "none is known",
        },
        [],
    )


def test_a_team_that_fits_together_is_fine():
    """One that has not said yet what it runs is no finding."""
    fine, findings = look(status(peer("r2"), peer("r3", version=None)))
    assert (fine["versions"], fine["limits"]) == (f"{version()} on all 3 robots", "the same on all 3 robots")
    assert findings == []


def test_each_robot_of_another_version_is_a_finding():
    """With both versions."""
    _, findings = look(status(peer("r2", version="0.0.9"), peer("r3")))
    assert findings == [("versions", f"r2 runs 0.0.9, here {version()}: install one on all robots")]


def test_limits_that_differ_are_told_in_the_words_of_the_daemon():
    """It knows which robot it is, and what to do."""
    text = "robot r2 has other limits (specs a, here b): give all robots the same constraints"
    fine, findings = look(status(peer("r2", takes_part=False), warnings=[text]))
    assert "limits" not in fine
    assert findings == [("daemon", text)]


@pytest.mark.parametrize("place", ["tcp/127.0.0.1:4711", "tcp/[::1]:4711"])
def test_a_process_of_this_robot_on_the_mesh_is_a_finding(place):
    """Once, also where the daemon warns of it; other hosts may be there, and robots."""
    links = [("abc", place), ("zid of r2", place), ("def", "tcp/192.0.2.1:4711")]
    _, findings = look(status(peer("r2"), links=links))
    assert findings == [
        (
            "applications",
            f"the Zenoh process abc of this robot is on the mesh itself, around the daemon, at {place}: {CURE}",
        )
    ]
    told = f"the application abc of this robot is on the mesh itself, around its daemon, at {place}: {CURE}"
    _, findings = look(status(peer("r2"), links=links, warnings=[told]))
    assert findings == [("applications", told)]


def test_a_router_of_this_host_that_the_daemon_dials_is_no_application():
    """As on an operator's machine, where zenohd runs beside it."""
    dials = Config(robot="r1", app=CONFIG.app, mesh=MeshConfig(mode="client", connect=(PLACE,)))
    told = status(links=[("abc", PLACE)])
    fine, _ = look(told, dials)
    assert fine["applications"] == "none is seen around the daemon"
    assert "applications" in dict(look(told)[1])


def test_a_daemon_that_is_not_what_is_installed_and_configured_is_a_finding():
    """It was started before, or otherwise."""
    told = status(version="0.0.9")
    _, findings = look(told, CONFIG.model_copy(update={"app": AppConfig(listen=("tcp/127.0.0.1:1",))}))
    assert findings[0] == ("daemon", f"0.0.9 runs, {version()} is installed: sudo systemctl restart sendworthy")
    assert findings[1][1].startswith(f"the daemon here has app.listen ['{HERE}'], not ['tcp/127.0.0.1:1']: restart it")
    assert look(told, None)[1] == findings[:1], "no configuration to compare it with"


@pytest.mark.parametrize("poor", [{}, {"peers": [{}], "daemon": {}}, {"daemon": {"links": [{}]}}])
def test_a_daemon_that_says_little_is_of_another_version(poor):
    """What it does not say is not compared."""
    _, findings = look({"robot": "r1"} | poor)
    assert findings == [
        ("daemon", f"another version runs, {version()} is installed: sudo systemctl restart sendworthy")
    ]


def test_without_a_daemon_it_is_said_what_is_missing():
    """And how to start one."""
    (found,) = alone("no daemon answers; is it running?")
    assert found.state == State.UNKNOWN
    assert found.text.startswith("no daemon answers: start it (sudo systemctl restart sendworthy)")
