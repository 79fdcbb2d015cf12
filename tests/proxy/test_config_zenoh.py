"""Zenoh's own part of the configuration."""

from proxy.config_zenoh import zenoh_problems


def test_what_zenoh_knows_has_no_problems():
    """A valid part of a Zenoh configuration passes, whatever its depth."""
    table = {"transport": {"link": {"tx": {"lease": 5000}}, "auth": {"usrpwd": {"user": "a", "password": "b"}}}}
    assert list(zenoh_problems(table)) == []
    assert list(zenoh_problems({})) == []


def test_unknown_keys_are_found_at_their_depth():
    """Each unknown key is named with its path and what was probably meant."""
    table = {"transprt": {}, "transport": {"unicast": {"max_link": 2}, "link": {"tx": {"lese": 1}}}}
    assert list(zenoh_problems(table)) == [
        (("transprt",), 'unknown key of Zenoh (did you mean "transport"?)'),
        (("transport", "unicast", "max_link"), 'unknown key of Zenoh (did you mean "max_links"?)'),
        (("transport", "link", "tx", "lese"), 'unknown key of Zenoh (did you mean "lease"?)'),
    ]


def test_wrong_values_are_told_in_zenohs_words():
    """Zenoh says what it wants; where in its source it says so is left out."""
    ((path, message),) = zenoh_problems({"connect": {"endpoints": ["tcp"]}})
    assert path == ("connect", "endpoints")
    assert message.startswith("Zenoh refuses it: Endpoints must be of the form <protocol>/<address>")
    assert " at /" not in message


def test_a_value_in_place_of_a_table_is_refused_as_a_whole():
    """What has no parts is reported where it is."""
    ((path, message),) = zenoh_problems({"transport": 3})
    assert path == ("transport",)
    assert message == "Zenoh refuses it: invalid type: integer `3`, expected struct TransportConf"


def test_files_that_are_named_must_be_there(tmp_path):
    """Certificates, keys, dictionaries: Zenoh itself would name neither the file nor the key."""
    here, gone = tmp_path / "ca.pem", str(tmp_path / "r1.key")
    here.touch()
    tls = {"root_ca_certificate": str(here), "listen_private_key": gone}
    table = {"transport": {"link": {"tls": tls}, "auth": {"usrpwd": {"dictionary_file": gone}}}}
    assert list(zenoh_problems(table)) == [
        (("transport", "link", "tls", "listen_private_key"), f"{gone} does not exist"),
        (("transport", "auth", "usrpwd", "dictionary_file"), f"{gone} does not exist"),
    ]
    assert list(zenoh_problems({"transport": {"link": {"tls": {"root_ca_certificate": "x" * 300}}}})) == []


def test_a_key_that_stands_in_place_of_its_file_is_not_repeated():
    """Messages go into logs."""
    pem = "-----BEGIN PRIVATE KEY-----\nhush\n-----END PRIVATE KEY-----"
    ((path, message),) = zenoh_problems({"transport": {"link": {"tls": {"listen_private_key": pem}}}})
    assert (path[-1], message) == ("listen_private_key", "(not shown) does not exist")


def test_a_key_below_what_is_no_table_is_unknown():
    """There is nothing that could have been meant."""
    ((path, message),) = zenoh_problems({"mode": {"router": {"x": 1}}})
    assert path[0] == "mode"
    assert message
