"""Whether certificates hold, on real ones."""

import shutil
import subprocess

import pytest

from proxy.config import AppConfig, Config, MeshConfig
from proxy.doctor.certificates import certificates
from proxy.doctor.finding import State

CURVE = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with an authority, `ca.pem`; `certify` makes a certificate of it that holds for so many days."""
    if shutil.which("openssl") is None:
        pytest.skip("needs openssl")
    folder = tmp_path_factory.mktemp("team")
    openssl(folder, "req", "-x509", *CURVE, "-days", "3650", "-subj", "/CN=our team", *out("ca"))
    for name, days in (("r1", 365), ("r2", 365), ("late", -1), ("soon", 5)):
        openssl(folder, "req", *CURVE, "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.csr")
        signed = ("-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", str(days))
        openssl(folder, "x509", "-req", "-in", f"{name}.csr", *signed, "-out", f"{name}.pem")
    openssl(folder, "req", "-x509", *CURVE, "-days", "365", "-subj", "/CN=r1", *out("stranger"))
    (folder / "none.pem").write_text("no certificate\n")
    return folder


def openssl(folder, *arguments):
    subprocess.run(["openssl", *arguments], cwd=folder, check=True, capture_output=True)


def out(name):
    return "-keyout", f"{name}.key", "-out", f"{name}.pem"


def tls(folder, listen="r1", connect=None, *, key=None, authority="ca"):
    """The table of a robot with these certificates."""
    connect = connect or listen
    return {
        "enable_mtls": True,
        "root_ca_certificate": str(folder / f"{authority}.pem"),
        "listen_certificate": str(folder / f"{listen}.pem"),
        "listen_private_key": str(folder / f"{key or listen}.key"),
        "connect_certificate": str(folder / f"{connect}.pem"),
        "connect_private_key": str(folder / f"{key or connect}.key"),
    }


def look(table, **options):
    zenoh = {"transport": {"link": {"tls": table}}} | options
    mesh = MeshConfig(listen=("tls/0.0.0.0:7500",), zenoh=zenoh)
    return [(each.state, each.text) for each in certificates(Config(robot="r1", mesh=mesh))]


def test_a_certificate_that_holds_is_told_until_when(made):
    """The same one for both ends is looked at once."""
    ((state, text),) = look(tls(made))
    assert state is State.FINE
    assert f"mesh.zenoh.transport.link.tls.listen_certificate: {made / 'r1.pem'}: holds until 20" in text
    assert [state for state, _ in look(tls(made, "r1", "r2"))] == [State.FINE, State.FINE]


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"listen": "late"}, "others refuse it: certificate has expired: have your authority make another one"),
        ({"listen": "stranger"}, "others refuse it: self-signed certificate"),
        ({"listen": "soon"}, ", and links with it: have your authority make another one"),
        ({"key": "r2"}, "r2.key is the key of another one: correct it"),
        ({"listen": "none", "key": "r1"}, "it, its key or the authority's is no PEM: correct it"),
        ({"authority": "none"}, "it, its key or the authority's is no PEM: correct it"),
        ({"listen": "nowhere"}, "No such file or directory: correct it"),
    ],
)
def test_what_keeps_robots_from_each_other_is_a_finding(made, table, told):
    """A daemon would say that there is no link, where it dials one, and nothing of why."""
    ((state, text),) = look(tls(made, **table))
    assert state is State.FINDING
    assert told in text


def test_the_end_that_dials_is_looked_at_too(made):
    """As who is dialled looks at it."""
    (_, fine), (state, text) = look(tls(made, "r1", "late"))
    assert "holds until" in fine
    assert state is State.FINDING
    assert f"tls.connect_certificate: {made / 'late.pem'}: others refuse it: certificate has expired" in text


def test_with_access_control_the_name_is_the_robots(made):
    """Else nobody takes what it says of itself; without it names are nobody's business."""
    control = {"enabled": True, "subjects": [{"id": "r1", "cert_common_names": ["r1", "r2"]}]}
    ((state, text),) = look(tls(made, "r2"), access_control=control)
    assert state is State.FINDING
    assert 'its name is "r2", so access control takes nothing that robot r1 says of itself' in text
    ((state, _),) = look(tls(made, "r1"), access_control=control)
    assert state is State.FINE
    ((state, _),) = look(tls(made, "r2"))
    assert state is State.FINE


def test_what_is_missing_is_named():
    """A daemon would not start without; robots without TLS need nothing."""
    assert [text for _, text in look({})] == [
        f"mesh.zenoh.transport.link.tls.listen_{what}: is missing, and tls/0.0.0.0:7500 takes one: set it"
        for what in ("certificate", "private_key")
    ]
    assert list(certificates(Config(robot="r1"))) == []
    app = AppConfig(listen=("quic/127.0.0.1:7447",))
    assert [each.text.split(".")[0] for each in certificates(Config(robot="r1", app=app))] == ["app", "app"]
