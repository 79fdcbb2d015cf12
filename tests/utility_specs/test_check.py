"""What `sendworthy check` says."""

import io

from tests.utility_specs.bad_specs import GOOD
from utility_specs.check import check


def run(*paths):
    out = io.StringIO()
    return check(paths, out), out.getvalue()


def test_good_specs_are_summed_up(tmp_path):
    """Per file: its types with keys and worth, its constraints in bytes per window."""
    path, limits = tmp_path / "camera.toml", tmp_path / "limits.toml"
    path.write_text(GOOD)
    limits.write_text('[[constraint]]\nkind = "throughput"\nname = "air"\nlimit = "1 kB/s"\nwindow = 2\n')
    summary = (
        f"{path}: 1 information type, 1 constraint\n"
        '  information_type "camera": robot/*/camera (video, most_recent, scale 1 × (1 + 10 * red))\n'
        '  constraint "throughput": 125000 B in any 0.5 s (2 Mbit/s)\n'
        f"{limits}: 0 information types, 1 constraint\n"
        '  constraint "air": 2000 B in any 2 s (0.008 Mbit/s)\n'
    )
    assert run(path, limits) == (0, summary)
    assert run(tmp_path) == (0, summary)


def test_a_python_utility_is_summed_up_with_its_function(tmp_path):
    """So that one sees what was found."""
    path = tmp_path / "camera.toml"
    path.write_text(GOOD.replace('"video"', '"python", function = "tests.utility_specs.worths:by_red"'))
    code, summary = run(path)
    assert code == 0
    assert "(python tests.utility_specs.worths:by_red, most_recent, scale 1 × (1 + 10 * red))" in summary


def test_bad_specs_are_named_line_by_line(tmp_path):
    """Every problem of every file is one line, and the exit code says so."""
    good, bad = tmp_path / "good.toml", tmp_path / "bad.toml"
    good.write_text(GOOD)
    bad.write_text('[[constraint]]\nkind = "air"\nlimit = 3\n')
    problems = (
        f"{tmp_path}/none.toml: does not exist\n"
        f'{bad}:2: constraint #1: kind: unknown kind "air" (known: "throughput")\n'
        f'{bad}:3: constraint #1: limit: needs a unit; write for example "2 Mbit/s"\n'
    )
    assert run(good, bad, tmp_path / "none.toml") == (1, problems)
