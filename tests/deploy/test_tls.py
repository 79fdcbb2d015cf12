"""Certificates on both sides of the mesh, as the manual has them."""

import json
import re
import shutil
import subprocess

import pytest

from tests.daemons import ROOT, Running
from tests.ports import free_port
from tests.proxy.nodes import Heard, plain_session
from tests.waiting import wait_until

MANUAL = (ROOT / "deploy" / "README.md").read_text().partition("\n### TLS\n")[2].partition("\n### ")[0]
FOLDER = "/etc/sendworthy/tls"


def block(language):
    (found,) = re.findall(rf"```{language}\n(.*?)```", MANUAL, re.DOTALL)
    return found


def certify(folder):
    """Run the commands of the manual; all robots are on this machine."""
    folder.mkdir()
    commands = re.sub(r"10\.0\.0\.\d+", "127.0.0.1", block("sh"))
    subprocess.run(["sh", "-ec", commands], cwd=folder, check=True, capture_output=True)
    return folder


def peers(daemon):
    return {peer["robot"] for peer in daemon.status()["peers"]}


@pytest.fixture
def mesh(tmp_path):
    """Start robots with what the manual says and the certificate of `holder`; all others dial r1."""
    if shutil.which("openssl") is None:
        pytest.skip("needs openssl")
    running, endpoint = {}, f"tls/127.0.0.1:{free_port()}"

    def start(name, certificates, holder):
        text = block("toml").replace(FOLDER, str(certificates)).replace("/r1.", f"/{holder}.")
        assert 'listen = ["tls/0.0.0.0:7500"]' in text
        file = tmp_path / f"{name}.toml"
        file.write_text(text)
        where = (
            ("--mesh.listen", json.dumps([endpoint])) if name == "r1" else ("--mesh.connect", json.dumps([endpoint]))
        )
        running[name] = Running("--config", str(file), "--robot", name, *where)
        running[name].wait_for("sendworthy ")
        return running[name]

    yield start
    for daemon in running.values():
        daemon.end()


@pytest.mark.full
def test_only_robots_with_a_certificate_of_the_team_take_part(mesh, tmp_path):
    """Commands and configuration of the manual, word for word; who has another authority's finds nobody."""
    ours, theirs = certify(tmp_path / "ours"), certify(tmp_path / "theirs")
    r1, visitor, r2 = mesh("r1", ours, "r1"), mesh("visitor", theirs, "r2"), mesh("r2", ours, "r2")
    wait_until(lambda: "r2" in peers(r1) and "r1" in peers(r2), what="r1 and r2 to meet")
    with (
        plain_session("client", connect=(r2.endpoint,)) as app,
        plain_session("client", connect=(r1.endpoint,)) as other,
    ):
        heard = Heard(other, "data")
        wait_until(lambda: app.put("data", "x") or heard.payloads, what="a sample from r2 at r1")
    visitor.wait_for("no link to tls/")
    assert peers(r1) == {"r2"}
    assert peers(visitor) == set()
