"""The Debian package, in a clean Debian that has booted: from its installation to its end."""

import json
import re
import shutil
import subprocess
import sys
from contextlib import ExitStack, closing

import pytest

from tests.system.debian import PYTHON, RELEASE, ROOT, Debian, packed
from tests.system.network import RADIO
from tests.system.robots import Listener, Speaker
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.system,
    pytest.mark.skipif(sys.version_info[:2] != PYTHON, reason=f"packages for {RELEASE} are made with its Python"),
]

ARCHITECTURE = subprocess.run(
    ["dpkg", "--print-architecture"], check=True, stdout=subprocess.PIPE, text=True
).stdout.strip()
CONFIG = "/etc/sendworthy/sendworthy.toml"
STATE = "/var/lib/sendworthy"
KEY = "robot/a/camera"
OWN = (
    ('#robot = "r1"', 'robot = "a"'),
    ("#specs = false", "specs = true"),
    ('#interface = "auto"', f'interface = "{RADIO}"'),
)
"""What an operator changes in the configuration."""
BOOKS = re.compile(r"/(var/(lib/dpkg|log)|etc/(passwd|group|shadow|gshadow|subuid|subgid)-?$|etc/\.pwd\.lock$)")
"""Where Debian writes down what was, packages and users."""


@pytest.fixture(scope="module")
def package():
    """The package of this machine."""
    return packed(ARCHITECTURE)


@pytest.fixture
def debian(network, tmp_path):
    """A host with a clean Debian."""
    with closing(Debian(network.add("a"), tmp_path / "debian", ARCHITECTURE)) as host:
        yield host


@pytest.fixture
def talk(network, start, tmp_path):
    """Start plain applications beside the daemon of `a` and beside another robot's; it tells what the latter hears."""
    with ExitStack() as closing_all:

        def talk():
            other = start("b", limit="200 kbit/s")
            wait_until(other.serves, what="start of b")
            listener = Listener(network.hosts["b"], tmp_path / "heard", "hear", KEY)
            closing_all.callback(listener.close)
            wait_until(listener.ready, what="an application of b")
            speaker = Speaker(network.hosts["a"], tmp_path / "spoken", "say", KEY, "4000", "20")
            closing_all.callback(speaker.close)
            wait_until(speaker.ready, what="an application of a")
            return lambda: len(listener.numbers(KEY))

        yield talk


def newer(package, folder):
    """The package of a version to come, whose sample of the configuration has another comment."""
    subprocess.run(["dpkg-deb", "--raw-extract", package, folder], check=True)
    control, sample = folder / "DEBIAN" / "control", folder / CONFIG.lstrip("/")
    control.write_text(re.sub(r"(?m)^Version: .*", r"\g<0>+1", control.read_text()))
    sample.write_text(f"# Of the version to come.\n{sample.read_text()}")
    made = folder.parent / "newer.deb"
    command = ("dpkg-deb", "--root-owner-group", "-Znone", "--build", folder, made)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    shutil.rmtree(folder)
    return made


def changed(text):
    """The configuration with what an operator changes."""
    for before, after in OWN:
        assert before in text
        text = text.replace(before, after)
    return text


def status(debian):
    """What the daemon says of itself."""
    said = debian.run("sendworthy", "status", "--json")
    assert said.returncode == 0, said.stderr
    return json.loads(said.stdout)


def crosses(heard):
    """Wait for more samples of the application."""
    count = heard()
    wait_until(lambda: heard() >= count + 5, what="samples of an application")


def test_from_its_installation_to_its_end(debian, package, talk, tmp_path):
    """It runs, takes specs, keeps what was changed when it is upgraded, and leaves nothing of it when it is purged."""
    there, config = debian.take(package), debian.folder / CONFIG.lstrip("/")
    upgrade = debian.take(newer(package, tmp_path / "newer"))
    before = debian.files()

    debian.dpkg("--install", there)
    assert debian.property("ActiveState") == "active"
    assert debian.property("UnitFileState") == "enabled"
    sample = config.read_text()
    config.write_text(changed(sample))
    assert debian.run("systemctl", "restart", "sendworthy").returncode == 0
    (debian.folder / "srv/pushed.toml").write_text(
        (ROOT / "utility_specs/surveillance.toml").read_text().replace("2 Mbit/s", "200 kbit/s")
    )
    pushed = debian.run("sendworthy", "push", "/srv/pushed.toml")
    assert pushed.returncode == 0, pushed.stderr
    assert (
        debian.run("stat", "--format=%U", f"{STATE}/specs.d", f"{STATE}/specs.d/pushed.toml").stdout
        == "sendworthy\n" * 2
    )
    (debian.folder / "srv/pushed.toml").unlink()
    heard = talk()
    crosses(heard)
    assert status(debian)["decisions"]["made"] > 0

    process = debian.property("MainPID")
    debian.dpkg("--install", "--force-confold", upgrade)
    wait_until(lambda: debian.property("ActiveState") == "active", what="the new daemon")
    assert debian.property("MainPID") not in (process, "0")
    assert config.read_text() == changed(sample)
    assert config.with_name("sendworthy.toml.dpkg-dist").read_text().startswith("# Of the version to come.")
    crosses(heard)
    found = status(debian)
    assert (found["robot"], found["warnings"]) == ("a", [])

    debian.dpkg("--remove", "sendworthy")
    assert debian.property("MainPID") == "0"
    left = {path for path in debian.files() - before if not BOOKS.match(path)}
    assert {CONFIG, f"{STATE}/specs.d/pushed.toml"} <= left
    assert not [path for path in left if path.startswith(("/opt", "/usr"))]

    debian.dpkg("--purge", "sendworthy")
    assert {path for path in debian.files() ^ before if not BOOKS.match(path)} == set()
    assert debian.run("id", "sendworthy").returncode == 0


def test_the_folder_of_specs_stays_as_an_operator_has_it(debian, package):
    """An upgrade leaves it to those who may write there, and is done though it is a link that leads nowhere."""
    there, specs = debian.take(package), f"{STATE}/specs.d"
    debian.dpkg("--install", there)
    debian.run("chown", "root:adm", specs)
    debian.run("chmod", "2775", specs)
    debian.dpkg("--install", there)
    assert debian.run("stat", "--format=%U %G %a", specs).stdout == "root adm 2775\n"
    debian.run("rmdir", specs)
    debian.run("ln", "-s", "/srv/specs", specs)
    debian.dpkg("--install", there)
    wait_until(lambda: debian.property("ActiveState") == "active", what="the daemon")
    assert debian.run("readlink", specs).stdout == "/srv/specs\n"
    debian.run("systemctl", "stop", "sendworthy")
    debian.run("rm", "-r", STATE)
    debian.run("ln", "-s", "/srv/state", STATE)  # as to a disk that is not there
    debian.dpkg("--install", there)
    assert debian.run("readlink", STATE).stdout == "/srv/state\n"


def test_all_of_it_is_installed(debian, package):
    """Both engines, manual page, completion, licences; all libraries are found, and nothing is written to it later."""
    debian.dpkg("--install", debian.take(package))
    listed = debian.run("dpkg", "--listfiles", "sendworthy").stdout.splitlines()
    for path in (
        *("/usr/bin/sendworthy", "/usr/share/man/man1/sendworthy.1.gz", "/usr/share/doc/sendworthy/copyright"),
        *("/usr/share/bash-completion/completions/sendworthy", "/usr/share/sendworthy/apps/client.json5"),
    ):
        assert path in listed
    assert [path for path in listed if path.endswith("/tests")] == []
    assert debian.run("readlink", "/opt/sendworthy/bin/python3").stdout == "/usr/bin/python3\n"
    assert debian.run("sendworthy", "--version").stdout.startswith("sendworthy ")
    for folder in ("tests/planner", "utility_specs"):
        shutil.copytree(ROOT / folder, debian.folder / "srv" / folder)
    assert debian.run("sendworthy", "check", "/srv/utility_specs/surveillance.toml").returncode == 0
    agreed = debian.run("/opt/sendworthy/bin/python3", "/srv/tests/planner/agreement.py")
    assert agreed.returncode == 0, agreed.stderr
    libraries = debian.run("sh", "-c", "ldd $(find /opt/sendworthy -name '*.so*' -type f)").stdout
    assert "libopencv" in libraries or "libavcodec" in libraries
    assert [line for line in libraries.splitlines() if "not found" in line] == []
    assert debian.run("dpkg", "--verify", "sendworthy").stdout == ""
    files = {path for path in debian.files() if path.startswith("/opt/sendworthy/")}
    assert files == {path for path in listed if path.startswith("/opt/sendworthy/")}
