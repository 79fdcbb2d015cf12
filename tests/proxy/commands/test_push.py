"""`sendworthy push` and `sendworthy mode --fleet`, with two daemons."""

import re
import signal

import pytest
import zenoh

from proxy import exit_codes
from proxy.bridge.fleet import Outcome, read_outcomes
from proxy.cli import main
from proxy.fleet_token import MISSING
from proxy.orders import FROM_ANYBODY
from tests.daemons import ROOT, specs_file
from tests.ports import free_port
from tests.proxy.nodes import Heard, answers, closing, plain_session
from tests.waiting import wait_until


@pytest.fixture
def team(start, tmp_path):
    """Two linked daemons, each with specs of its own in a folder; r2 obeys all orders, r1 takes no specs."""
    mesh = f"tcp/127.0.0.1:{free_port()}"
    daemons = []
    for name, options in (
        ("r1", ("--mesh.listen", f'["{mesh}"]', "--fleet.mode", "true")),
        ("r2", ("--mesh.connect", f'["{mesh}"]', "--fleet.mode", "true", "--fleet.specs", "true")),
    ):
        folder = tmp_path / name / "specs.d"
        folder.mkdir(parents=True)
        specs_file(folder)
        daemon = start("--robot", name, "--specs.path", str(folder), *options)
        daemon.wait_for("sendworthy ")
        daemons.append(daemon)
    wait_until(lambda: all(daemon.status()["peers"] for daemon in daemons), what="the robots to meet")
    return daemons


def test_specs_and_modes_reach_the_team(team, tmp_path, capsys):
    """Each robot answers for itself; who may not be ordered says so and keeps what it has."""
    new = specs_file(tmp_path)
    new.write_text(new.read_text().replace("2 Mbit/s", "1 Mbit/s"))
    before = team[0].status()["specs"]
    assert main(["push", str(new), "--connect", team[0].endpoint]) == exit_codes.FAILED
    out, err = capsys.readouterr()
    assert err == "r1: fleet.specs is false in its configuration\n"
    assert out == f"r2: specs {team[1].status()['specs']} in force\n"
    assert team[0].status()["specs"] == before != team[1].status()["specs"]
    assert (tmp_path / "r2" / "specs.d" / new.name).read_text() == new.read_text()
    assert main(["mode", "shadow", "--fleet", "--connect", team[0].endpoint]) == exit_codes.OK
    assert capsys.readouterr().out == "r1: mode shadow\nr2: mode shadow\n"
    assert [daemon.status()["mode"] for daemon in team] == ["shadow", "shadow"]
    team[1].end(signal.SIGTERM)
    wait_until(lambda: not team[0].status()["peers"], what="the other one to be gone")
    assert main(["mode", "pass", "--fleet", "--connect", team[0].endpoint]) == exit_codes.OK
    assert capsys.readouterr().out == "r1: mode pass\n"


def test_specs_with_mistakes_are_not_even_sent(tmp_path, capsys):
    """They are checked here, as `sendworthy check` does it; nobody is asked."""
    specs = specs_file(tmp_path)
    specs.write_text(specs.read_text().replace('"video"', '"vidoe"'))
    assert main(["push", str(specs), "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith(f'{specs}:10: information_type "camera": utility.kind: ')


def test_robots_may_check_what_cannot_be_checked_here(start, tmp_path, capsys):
    """What needs a module that only they have goes unchecked, and their mistakes come back."""
    specs = specs_file(tmp_path)
    specs.write_text(specs.read_text().replace('kind = "video"', 'kind = "python", function = "not_here:worth"'))
    folder = tmp_path / "specs.d"
    daemon = start("--robot", "r1", "--fleet.specs", "true", "--specs.path", str(specs_file(make(folder)).parent))
    daemon.wait_for("sendworthy ")
    assert main(["push", str(specs), "--unchecked", "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith('r1: camera.toml:10: information_type "camera": utility.function: ')


def make(folder):
    folder.mkdir()
    return folder


def test_without_a_daemon_nothing_is_pushed(tmp_path, capsys):
    """The message is that of all commands."""
    assert main(["push", str(specs_file(tmp_path)), "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith("sendworthy push: no daemon answers at tcp/127.0.0.1:1")
    assert main(["mode", "pass", "--fleet", "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith("sendworthy mode: no daemon answers at tcp/127.0.0.1:1")


KNOWN = "a token of this team"


class Eavesdropper:
    """A plain Zenoh node on a mesh without TLS: it is asked what robots are asked, and answers nothing."""

    def __init__(self, stack, meshes):
        self.heard = []
        self.session = closing(stack, plain_session("peer", connect=meshes))
        take = zenoh.handlers.Callback(self._take, indirect=False)
        self.session.declare_queryable("@sendworthy/eavesdropper/fleet/*", take)
        wait_until(lambda: len(self.session.info.peers_zid()) >= len(meshes), what="links to all")

    def _take(self, query):
        with query:
            said = [bytes(each or b"") for each in (query.payload, query.attachment)]
            self.heard.append((str(query.key_expr).rpartition("/")[2], *said))

    def repeat(self, order, payload, proofs):
        """Give r2 an order once more; return what it says."""
        (answer,) = answers(self.session, f"@sendworthy/r2/fleet/{order}", payload=payload, attachment=proofs)
        return read_outcomes(answer.encode())


@pytest.fixture
def sworn(start, stack, tmp_path):
    """Two robots with the team's token, one in a file and one in a variable, and somebody who hears what they say."""
    meshes, file = [f"tcp/127.0.0.1:{free_port()}" for _ in range(2)], tmp_path / "token"
    file.write_text(f"{KNOWN}\n")
    orders, (first, second) = ("--fleet.mode", "true"), meshes
    r1 = start("--robot", "r1", "--mesh.listen", f'["{first}"]', *orders, "--fleet.token_file", str(file))
    dial = ("--mesh.listen", f'["{second}"]', "--mesh.connect", f'["{first}"]')
    r2 = start("--robot", "r2", *dial, *orders, SENDWORTHY_FLEET__TOKEN=KNOWN)
    for robot in (r1, r2):
        robot.wait_for("sendworthy ")
    wait_until(lambda: all(robot.status()["peers"] for robot in (r1, r2)), what="the robots to meet")
    return r1, r2, file, Eavesdropper(stack, meshes)


def modes(*robots):
    return [robot.status()["mode"] for robot in robots]


@pytest.mark.full
def test_robots_with_a_token_obey_who_knows_it(sworn, capsys, monkeypatch):
    """Others are refused, logged and counted; the token is on no link, and what is there gives no second order."""
    r1, r2, file, eavesdropper = sworn
    order = ("--fleet", "--connect", r1.endpoint)
    assert main(["mode", "shadow", *order]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"r1: {MISSING}\nr2: {MISSING}\n"
    assert modes(r1, r2) == ["enforce", "enforce"]
    for robot in (r1, r2):
        robot.wait_for("an order is refused (mode): it takes the token")
        wait_until(lambda robot=robot: robot.status()["refused"].get("order:unproved") == 1, what="the count")
    assert main(["mode", "shadow", *order, "--token-file", str(file)]) == exit_codes.OK
    assert capsys.readouterr().out == "r1: mode shadow\nr2: mode shadow\n"
    assert modes(r1, r2) == ["shadow", "shadow"]
    monkeypatch.setenv("SENDWORTHY_FLEET__TOKEN", KNOWN)
    assert main(["mode", "pass", *order]) == exit_codes.OK
    assert modes(r1, r2) == ["pass", "pass"]
    assert [name for name, *_ in eavesdropper.heard] == ["mode", "challenge", "mode", "challenge", "mode"]
    assert not any(KNOWN.encode() in said for _, *all_said in eavesdropper.heard for said in all_said)
    old = next(each for each in eavesdropper.heard if each[1] == b"shadow" and each[2])
    assert eavesdropper.repeat(*old) == [Outcome("r2", obeyed=False, said=("the order was given before",))]
    assert modes(r1, r2) == ["pass", "pass"]


@pytest.mark.full
def test_a_wrong_token_is_refused_and_a_bad_one_not_even_sent(sworn, tmp_path, capsys, monkeypatch):
    """What each robot says tells which it was."""
    r1, *_ = sworn
    wrong = tmp_path / "wrong"
    wrong.write_text("a token of that team")
    order = ["mode", "shadow", "--fleet", "--connect", r1.endpoint]
    assert main([*order, "--token-file", str(wrong)]) == exit_codes.FAILED
    said = "the order was given with another token"
    assert capsys.readouterr().err == f"r1: {said}\nr2: {said}\n"
    monkeypatch.setenv("SENDWORTHY_FLEET__TOKEN", "short")
    assert main(order) == exit_codes.FAILED
    assert "SENDWORTHY_FLEET__TOKEN: a token has 16 to 4096" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*order, "--token-file", str(tmp_path / "nowhere")])
    assert "nowhere: cannot be read" in capsys.readouterr().err


@pytest.mark.full
def test_a_token_file_that_is_replaced_holds_at_once(sworn, capsys):
    """Nothing said that the one before was in force still, for whoever knows it."""
    r1, r2, file, _ = sworn
    before, order = file.with_name("before"), ["mode", "shadow", "--fleet", "--connect", r1.endpoint, "--token-file"]
    before.write_text(KNOWN)
    file.write_text("a token of that team")
    other = "the order was given with another token"
    assert main([*order, str(before)]) == exit_codes.FAILED
    assert capsys.readouterr() == ("r2: mode shadow\n", f"r1: {other}\n")
    assert main([*order, str(file)]) == exit_codes.FAILED
    assert capsys.readouterr() == ("r1: mode shadow\n", f"r2: {other}\n")
    assert modes(r1, r2) == ["shadow", "shadow"]


@pytest.mark.full
@pytest.mark.parametrize("token", ["", KNOWN])
def test_python_runs_for_who_knows_the_token_alone(start, tmp_path, capsys, monkeypatch, token):
    """Without one whoever is on the mesh could have robots run anything by specs."""
    specs = specs_file(tmp_path)
    specs.write_text(f'{specs.read_text()}features.x = {{ kind = "python", function = "operator:contains" }}\n')
    monkeypatch.setenv("SENDWORTHY_FLEET__TOKEN", token)
    robot = start("--robot", "r1", "--specs.path", str(tmp_path / "specs.d"), "--fleet.specs", "true")
    robot.wait_for("sendworthy ")
    obeyed = main(["push", str(specs), "--connect", robot.endpoint]) == exit_codes.OK
    assert obeyed == bool(token)
    assert (FROM_ANYBODY in capsys.readouterr().err) == (not token)
    assert (tmp_path / "specs.d").exists() == bool(token)


@pytest.fixture
def guarded(start, tmp_path):
    """Three robots with passwords, as in the manual; r1 obeys, and it and the operator have its access control."""
    manual = (ROOT / "docs" / "guides" / "security.md").read_text()
    (acl,) = [block for block in re.findall(r"```toml\n(.*?)```", manual, re.DOTALL) if "access_control" in block]
    dictionary, folder, mesh = tmp_path / "robots", tmp_path / "specs.d", f"tcp/127.0.0.1:{free_port()}"
    dictionary.write_text("".join(f"{name}:a secret of {name}\n" for name in ("r1", "ground", "visitor")))
    acl = acl.replace("/etc/sendworthy/robots", str(dictionary))
    orders = ("--fleet.specs", "true", "--fleet.mode", "true")
    obeys = ("--mesh.listen", f'["{mesh}"]', *orders, "--specs.path", str(folder))
    specs_file(make(folder))
    daemons = []
    for name, options in (
        ("r1", obeys),
        *((name, ("--mesh.connect", f'["{mesh}"]')) for name in ("ground", "visitor")),
    ):
        file = tmp_path / f"{name}.toml"
        said = acl[: acl.index("[mesh.zenoh.access")] if name == "visitor" else acl
        file.write_text(said.replace("r1", name))
        daemons.append(start("--config", str(file), "--robot", name, *options))
    for daemon in daemons:
        daemon.wait_for("sendworthy ")
    wait_until(lambda: [len(daemon.status()["peers"]) for daemon in daemons] == [2, 1, 1], what="the robots to meet")
    return daemons


@pytest.mark.full
def test_access_control_lets_one_operator_order_and_no_other(guarded, tmp_path, capsys):
    """What is in the manual, word for word: the robot obeys the one and does not hear the other."""
    new = specs_file(tmp_path)
    new.write_text(new.read_text().replace("2 Mbit/s", "1 Mbit/s"))
    r1, ground, visitor = guarded
    before = r1.status()["specs"]
    main(["push", str(new), "--connect", visitor.endpoint])
    assert "r1: no answer: it is out of reach, or fleet.specs is false" in capsys.readouterr().err
    assert r1.status()["specs"] == before
    main(["push", str(new), "--connect", ground.endpoint])
    assert f"r1: specs {r1.status()['specs']} in force\n" in capsys.readouterr().out
    assert r1.status()["specs"] != before
    main(["mode", "shadow", "--fleet", "--connect", visitor.endpoint])
    assert r1.status()["mode"] == "enforce"
    main(["mode", "shadow", "--fleet", "--connect", ground.endpoint])
    assert "r1: mode shadow\n" in capsys.readouterr().out
    assert not [line for robot in guarded for line in robot.lines if "ERROR" in line]
    with (
        plain_session("client", connect=[visitor.endpoint]) as app,
        plain_session("client", connect=[r1.endpoint]) as other,
    ):
        heard = Heard(other, "data")
        wait_until(lambda: app.put("data", "x") or heard.payloads, what="data, which everybody may send")
