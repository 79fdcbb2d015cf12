"""`sendworthy check`."""

import json

from proxy import exit_codes
from proxy.cli import main

GOOD = """\
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "most_recent"
utility = { kind = "video" }
"""


def test_good_specs_pass(tmp_path, capsys):
    """Right specs give exit code 0 and name the file."""
    file = tmp_path / "camera.toml"
    file.write_text(GOOD)
    assert main(["check", str(file)]) == exit_codes.OK
    shown = capsys.readouterr()
    assert str(file) in shown.out
    assert shown.err == ""


def test_a_mistake_is_named_with_file_line_and_key(tmp_path, capsys):
    """Wrong specs give exit code 1 and a line for the mistake."""
    file = tmp_path / "camera.toml"
    file.write_text(GOOD.replace('"video"', '"vidoe"'))
    assert main(["check", str(file)]) == exit_codes.FAILED
    assert capsys.readouterr().out.startswith(f'{file}:5: information_type "camera": utility')


def test_a_configuration_is_checked_with_its_specs(tmp_path, capsys):
    """As the daemon would read it; mistakes in either fail."""
    config, specs = tmp_path / "sendworthy.toml", tmp_path / "camera.toml"
    config.write_text('robot = "r1"\n')
    assert main(["check", "--config", str(config)]) == exit_codes.OK
    without = f"{config}: right, no specs in {tmp_path}/specs.d: everything passes\n"
    assert capsys.readouterr().out == without
    (tmp_path / "specs.d").mkdir()
    assert main(["check", "--config", str(config)]) == exit_codes.OK
    assert capsys.readouterr().out == without
    config.write_text('robot = "r1"\n[specs]\npath = "camera.toml"\n')
    specs.write_text(GOOD)
    assert main(["check", "--config", str(config)]) == exit_codes.OK
    assert capsys.readouterr().out.startswith(f"{config}: right\n{specs}: 1 information type")
    specs.write_text(GOOD.replace('"video"', '"vidoe"'))
    assert main(["check", "--config", str(config)]) == exit_codes.FAILED
    assert f"{specs}:5: " in capsys.readouterr().out
    config.write_text('[planner]\ncoordination = "shares"\n')
    assert main(["check", "--config", str(config)]) == exit_codes.OK
    assert capsys.readouterr().out.startswith(f'{config}:2: planner.coordination: "shares" is called "split" now')
    config.write_text("mode = 'fast'\n")
    assert main(["check", "--config", str(config)]) == exit_codes.FAILED
    assert capsys.readouterr().out.startswith(f"{config}:1: mode: ")


def test_nothing_to_check_is_a_mistake(capsys):
    """Neither files nor a configuration."""
    assert main(["check"]) == exit_codes.USAGE
    assert capsys.readouterr().err == "sendworthy check: give it a FILE or --config\n"


def test_scripts_get_json_and_nothing_else(tmp_path, capsys):
    """What is said of the configuration goes to standard error."""
    (tmp_path / "camera.toml").write_text(GOOD)
    config = tmp_path / "sendworthy.toml"
    config.write_text(f'[specs]\npath = "{tmp_path}/camera.toml"\n')
    assert main(["check", "--json", "--config", str(config)]) == exit_codes.OK
    shown = capsys.readouterr()
    assert json.loads(shown.out)["fit"]
    assert shown.err == f"{config}: right\n"
    config.write_text('robot = "r1"\n')
    assert main(["check", "--json", "--config", str(config)]) == exit_codes.OK
    assert json.loads(capsys.readouterr().out) == {"fit": True, "errors": [], "warnings": [], "files": []}
    config.write_text('mode = "fast"\n')
    assert main(["check", "--json", "--config", str(config)]) == exit_codes.FAILED
    found = json.loads(capsys.readouterr().out)
    assert (found["fit"], [each["file"] for each in found["errors"]]) == (False, [str(config)])
    assert found["errors"][0]["message"].startswith(f"{config}:1: mode: unknown")
