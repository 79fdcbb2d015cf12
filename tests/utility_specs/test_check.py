"""What `sendworthy check` says."""

import io

import pytest

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


@pytest.mark.parametrize(
    ("table", "summary"),
    [
        ('kind = "messages"\nlimit = 5\n', "5 messages in any 0.5 s (10/s)"),
        (
            'kind = "airtime"\nlimit = "40 %"\nrate = "8 Mbit/s"\nhops = 2\n',
            "200 ms on the air in any 0.5 s (40 %; adhoc, unicast, 8 Mbit/s, 2 hops; 1 kB takes 2.73 ms)",
        ),
        (
            'kind = "throughput"\nlimit = "adaptive"\nceiling = "4 Mbit/s"\nfloor = "1 Mbit/s"\n',
            "250000 B in any 0.5 s (4 Mbit/s); adaptive, down to 25 % of it",
        ),
        (
            'kind = "airtime"\nlimit = "adaptive"\nceiling = "40 %"\nrate = "8 Mbit/s"\n',
            "200 ms on the air in any 0.5 s (40 %; adhoc, unicast, 8 Mbit/s, 1 hop; 1 kB takes 1.36 ms); "  # noqa: ISC004
            "adaptive, down to 5 % of it",
        ),
        (
            'kind = "energy"\nlimit = "0.5 J"\nwindow = 10\nper_byte = "2 uJ"\nper_message = "1 mJ"\n',
            "0.5 J of each robot in any 10 s (0.05 W; 1 kB takes 3 mJ)",
        ),
    ],
)
def test_a_limit_is_told_in_the_terms_of_its_kind(tmp_path, table, summary):
    """What a window holds, what that is by the second, and what a message of 1 kB takes of it."""
    path = tmp_path / "spec.toml"
    path.write_text(f'{GOOD}\n[[constraint]]\nname = "other"\n{table}')
    code, out = run(path)
    assert (code, out.splitlines()[-1]) == (0, f'  constraint "other": {summary}')


def test_a_python_utility_is_summed_up_with_its_function(tmp_path):
    """So that one sees what was found."""
    path = tmp_path / "camera.toml"
    path.write_text(GOOD.replace('"video"', '"python", function = "tests.utility_specs.worths:by_red"'))
    code, summary = run(path)
    assert code == 0
    assert "(python tests.utility_specs.worths:by_red, most_recent, scale 1 × (1 + 10 * red))" in summary


def test_an_aggregation_is_summed_up_by_its_name_or_class(tmp_path):
    """Likewise."""
    path = tmp_path / "camera.toml"
    path.write_text(GOOD.replace('"most_recent"', '"best"'))
    assert "(video, best, scale 1" in run(path)[1]
    path.write_text(GOOD.replace('"most_recent"', '{ python = "tests.utility_specs.models:Greatest" }'))
    assert "(video, python tests.utility_specs.models:Greatest, scale 1" in run(path)[1]


def test_bad_specs_are_named_line_by_line(tmp_path):
    """Every problem of every file is one line, and the exit code says so."""
    good, bad = tmp_path / "good.toml", tmp_path / "bad.toml"
    good.write_text(GOOD)
    bad.write_text('[[constraint]]\nkind = "air"\nlimit = 3\n')
    problems = (
        f"{tmp_path}/none.toml: does not exist\n"
        f'{bad}:2: constraint #1: kind: unknown kind "air" (did you mean "airtime"?)\n'
    )
    assert run(good, bad, tmp_path / "none.toml") == (1, problems)
