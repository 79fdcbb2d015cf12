"""`sendworthy check`."""

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
