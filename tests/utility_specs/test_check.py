"""What `sendworthy check` says."""

import io
import json

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
    limits.write_text('[[constraint]]\nkind = "throughput"\nname = "air"\nlimit = "4 Mbit/s"\nwindow = 0.1\n')
    summary = (
        f"{path}: 1 information type, 1 constraint\n"
        '  information_type "camera": robot/*/camera (video, most_recent, scale 1 + 10 * red)\n'
        '  constraint "throughput": 125000 B in any 0.5 s (2 Mbit/s)\n'
        f"{limits}: 0 information types, 1 constraint\n"
        '  constraint "air": 50000 B in any 0.1 s (4 Mbit/s)\n'
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
            "adaptive, down to 0.2 % of it",
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
    assert "(python tests.utility_specs.worths:by_red, most_recent, scale 1 + 10 * red)" in summary


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


def test_warnings_follow_the_summary_and_leave_specs_fit(tmp_path):
    """The exit code is that of good specs."""
    path = tmp_path / "camera.toml"
    path.write_text("constants.x = 1\n" + GOOD)
    code, out = run(path)
    assert code == 0
    assert out.splitlines()[0] == f"{path}: 1 information type, 1 constraint"
    assert out.splitlines()[-1] == f"warning: {path}:1: constants.x: nothing in this file uses this constant"


def test_guarantees_that_nobody_can_keep_are_mistakes(tmp_path):
    """Then there is no summary."""
    path = tmp_path / "camera.toml"
    path.write_text(GOOD.replace('{ features = "last" }', '{ size = "1 MB" }') + 'min_rate = "1 Hz"\n')
    code, out = run(path)
    assert code == 1
    assert [line.partition(":")[0] for line in out.splitlines()] == [str(path), "warning"]
    assert 'limit: is less than what is guaranteed: "camera" (400 %)' in out


def test_everything_can_be_had_as_json(tmp_path):
    """For scripts: problems with their places, and what the files say."""
    path, out = tmp_path / "camera.toml", io.StringIO()
    path.write_text("constants.x = 1\n" + GOOD)
    assert check([path], out, as_json=True) == 0
    unused = "nothing in this file uses this constant"
    assert json.loads(out.getvalue()) == {
        "fit": True,
        "errors": [],
        "warnings": [{"file": str(path), "line": 1, "key": "constants.x", "message": unused}],
        "files": [
            {
                "file": str(path),
                "information_types": {"camera": ["robot/*/camera"]},
                "constraints": {"throughput": "125000 B in any 0.5 s (2 Mbit/s)"},
            }
        ],
    }
    path.write_text("x =")
    out = io.StringIO()
    assert check([path], out, as_json=True) == 1
    assert [each["line"] for each in json.loads(out.getvalue())["errors"]] == [1]
