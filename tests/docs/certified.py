"""A team that is set up by what `docs/guides/security.md` says, command by command, on this machine."""

import json
import re
import shutil
import subprocess
import sys
import tomllib

import pytest
import zenoh

from tests.daemons import ROOT, Running
from tests.ports import free_port
from tests.waiting import wait_until

PAGE = ROOT / "docs" / "guides" / "security.md"
ETC = "/etc/sendworthy"
NAMES = ("r1", "r2", "ground")


def blocks(step, language):
    """The code of one step of the page, in order; `step` is how its heading begins."""
    (text,) = [part for part in re.split(r"^## ", PAGE.read_text(), flags=re.MULTILINE) if part.startswith(step)]
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


class Team:
    """Folders of the team's robots, made by the page's commands; `start` runs a daemon with what is in one."""

    def __init__(self, folder, stack):
        if shutil.which("openssl") is None:
            pytest.skip("needs openssl")
        self.folder = folder
        self._stack = stack
        self.certify(folder)
        self.endpoints = {name: f"tls/127.0.0.1:{free_port()}" for name in NAMES}

    @property
    def made(self):
        """Where the commands of the page leave what they make."""
        return self.folder / "team"

    def certify(self, folder):
        """Make an authority, and certificates of it, in a folder `team` of this folder."""
        make, _ = blocks("1.", "sh")
        self.sh(re.sub(r"10\.0\.0\.\d+", "127.0.0.1", make), folder)

    def sh(self, commands, cwd, etc=None):
        """Run commands of the page; what they do as root is done in a folder of the test."""
        here = re.sub(r"sudo (?=install)| --group sendworthy", "", commands).replace(ETC, str(etc))
        program = f'sendworthy() {{ {sys.executable} -m proxy.cli "$@"; }}\nsudo() {{ :; }}\n'
        subprocess.run(["sh", "-ec", program + here], cwd=cwd, check=True, capture_output=True)

    def etc(self, name):
        """The configuration of a robot, as the first step leaves it."""
        etc = self.folder / name
        if not etc.exists():
            _, install = blocks("1.", "sh")
            self.sh(install.replace("r1.", f"{name}."), self.made, etc)
            (conf,) = blocks("1.", "toml")
            (etc / "conf.d").mkdir()
            (etc / "conf.d" / "tls.toml").write_text(conf.replace(ETC, str(etc)))
            (etc / "sendworthy.toml").write_text(f'robot = "{name}"\n')
        return etc

    def control(self, name):
        """The second step."""
        commands, _ = blocks("2.", "sh")
        self.sh(commands, self.made, self.etc(name))

    def swear(self, name):
        """The third step, with the token that was made first."""
        make, _ = blocks("3.", "sh")
        if (self.made / "fleet.token").exists():
            make = "\n".join(make.splitlines()[1:])
        self.sh(make, self.made, self.etc(name))
        (conf,) = blocks("3.", "toml")
        (self.etc(name) / "conf.d" / "fleet.toml").write_text(conf.replace(ETC, str(self.etc(name))))

    def start(self, name, *others, via=None):
        """Start a robot's daemon, which dials `others`, and the endpoint `via` that leads to one."""
        dialled = [*(self.endpoints[other] for other in others), *([via] if via else [])]
        where = ("--mesh.listen", json.dumps([self.endpoints[name]]), "--mesh.connect", json.dumps(dialled))
        daemon = Running("--config", str(self.etc(name) / "sendworthy.toml"), *where)
        self._stack.callback(daemon.end)
        daemon.wait_for("sendworthy ")
        return daemon

    def router(self):
        """A router of its own with a certificate and the access control that is printed for it; return its endpoint."""
        endpoint = f"tls/127.0.0.1:{free_port()}"
        self._certify_one("router")
        tls = tomllib.loads((self.etc("router") / "conf.d" / "tls.toml").read_text())["mesh"]["zenoh"]["transport"]
        (printed,) = blocks("2.", "sh")[1:]
        self.sh(printed, self.made)
        options = json.loads("\n".join((self.made / "access.json5").read_text().splitlines()[1:]))
        options |= {"mode": "router", "listen": {"endpoints": [endpoint]}, "transport": tls}
        options["scouting"] = {"multicast": {"enabled": False}}
        session = zenoh.open(zenoh.Config.from_json5(json.dumps(options)))
        self._stack.callback(session.close)
        return endpoint

    def session(self, name, *others):
        """A plain Zenoh session with the certificate of a robot, and nothing else of it: an insider with a program."""
        conf = tomllib.loads((self.etc(name) / "conf.d" / "tls.toml").read_text())["mesh"]["zenoh"]
        return dialling([self.endpoints[other] for other in others], conf["transport"])

    def session_at(self, name, endpoint):
        """The same at a router, as its client."""
        conf = tomllib.loads((self.etc(name) / "conf.d" / "tls.toml").read_text())["mesh"]["zenoh"]
        return dialling([endpoint], conf["transport"], "client")

    def newcomer(self, name, *others):
        """The same for one who gets a certificate of the team later."""
        self._certify_one(name)
        return self.session(name, *others)

    def _certify_one(self, name):
        make, _ = blocks("1.", "sh")
        _, ec, _, *rest = make.splitlines()
        self.sh(re.sub("for robot in .*; do", f"for robot in {name}=127.0.0.1; do", "\n".join([ec, *rest])), self.made)


def dialling(endpoints, transport, mode="peer"):
    """A session that tries to link to these endpoints, and goes on without."""
    options = {
        "mode": mode,
        "connect": {
            "endpoints": endpoints,
            "timeout_ms": -1,
            "exit_on_failure": False,
            "retry": {"period_max_ms": 500},
        },
        "listen": {"endpoints": []},
        "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": transport,
    }
    return zenoh.open(zenoh.Config.from_json5(json.dumps(options)))


def meet(*daemons):
    """Wait until each knows all the others."""
    for daemon in daemons:
        wait_until(lambda daemon=daemon: len(peers(daemon)) == len(daemons) - 1, what="the robots to meet")


def peers(daemon):
    return {peer["robot"] for peer in daemon.status()["peers"]}
