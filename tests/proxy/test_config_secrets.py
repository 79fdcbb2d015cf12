"""What of a configuration nobody is shown."""

import pytest

from proxy.config_secrets import HIDDEN, without_secrets


@pytest.mark.parametrize(
    "path",
    [
        ("mesh", "zenoh", "transport", "auth", "usrpwd", "password"),
        ("mesh", "zenoh", "transport", "auth", "pubkey", "private_key_pem"),
        ("mesh", "zenoh", "transport", "link", "tls", "listen_private_key_base64"),
        ("fleet", "token"),
        ("fleet", "push_token"),
        ("fleet", "tokens", "ground"),
    ],
)
def test_what_keeps_others_out_is_hidden(path):
    """Under whatever table, alone or in a list or a table around it."""
    assert without_secrets("abc", path) == HIDDEN
    assert without_secrets(["abc", 7], path) == [HIDDEN, HIDDEN]
    nested = "abc"
    for part in reversed(path):
        nested = {part: nested}
    assert "abc" not in str(without_secrets(nested))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("mesh", "zenoh", "transport", "link", "tls", "listen_private_key"), "/etc/sendworthy/tls/r1.key"),
        (("mesh", "zenoh", "transport", "auth", "usrpwd", "user"), "r1"),
        (("mesh", "zenoh", "transport", "auth", "usrpwd", "password"), ""),
        (("fleet", "token_file"), "/etc/sendworthy/token"),
        (("bridge", "out", "deny"), ["secrets/**"]),
        (("mesh", "listen"), ["tcp/0.0.0.0:7500#iface=wlan0"]),
        (("fleet", "mode"), True),
        (("queue", "samples"), 64),
    ],
)
def test_all_else_is_shown(path, value):
    """Paths of files are no secret, nor that there is no password."""
    assert without_secrets(value, path) == value


def test_keys_within_endpoints_and_texts_are_hidden():
    """The rest of the endpoint is not."""
    endpoint = "tls/0.0.0.0:7500#listen_private_key_base64=QUJD;iface=wlan0"
    assert without_secrets([endpoint], ("mesh", "listen")) == [
        f"tls/0.0.0.0:7500#listen_private_key_base64={HIDDEN};iface=wlan0"
    ]
    pem = "-----BEGIN EC PRIVATE KEY-----\nabc"
    assert without_secrets(pem, ("mesh", "zenoh", "x")) == HIDDEN
