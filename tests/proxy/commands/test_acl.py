"""`sendworthy acl`."""

import json
import tomllib

import pytest

from proxy import exit_codes
from proxy.access import access_control
from proxy.cli import main
from proxy.config_loading import load_config


def test_what_is_printed_is_a_configuration(tmp_path, capsys):
    """As it is, with how it was made."""
    assert main(["acl", "--robots", "r1, ground", "--operators", "ground"]) == exit_codes.OK
    printed = capsys.readouterr().out
    assert printed.startswith("# Printed by: sendworthy acl --robots r1,ground --operators ground\n")
    control = access_control(("r1", "ground"), ("ground",))
    assert tomllib.loads(printed) == {"mesh": {"zenoh": {"access_control": control}}}
    file = tmp_path / "sendworthy.toml"
    file.write_text(printed)
    assert load_config(file, {}, {}).mesh.zenoh["access_control"] == control


def test_for_a_router_it_is_a_part_of_its_own_configuration(capsys):
    """As JSON5, which has comments."""
    assert main(["acl", "--robots", "r1,ground", "--router"]) == exit_codes.OK
    first, *rest = capsys.readouterr().out.splitlines()
    assert first == "// Printed by: sendworthy acl --robots r1,ground --router"
    assert json.loads("\n".join(rest)) == {"access_control": access_control(("r1", "ground"))}


def test_an_operator_is_a_robot(capsys):
    """Else nobody could be it."""
    assert main(["acl", "--robots", "r1", "--operators", "boss"]) == exit_codes.FAILED
    assert capsys.readouterr().err == "sendworthy acl: boss: an operator is one of the robots, too\n"


@pytest.mark.parametrize("names", ["", "r1,,r2", "a/b", "r*"])
def test_what_is_no_name_is_refused(names, capsys):
    """As in the configuration."""
    with pytest.raises(SystemExit):
        main(["acl", "--robots", names])
    assert "argument --robots: must " in capsys.readouterr().err
