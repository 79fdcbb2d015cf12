"""Loading specs: from good files, and from all kinds of broken ones."""

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.airtime import Airtime
from planner.measures import Energy, Messages, Throughput
from planner.problem import Aggregation
from planner.utility import Linear, Video
from tests.utility_specs.bad_rules import RULES
from tests.utility_specs.bad_specs import CORPUS, GOOD, Bad
from utility_specs import SpecsError, load_specs
from utility_specs.loader import load_set

BROKEN = [*CORPUS, *RULES]
SECOND = """\
[[information_type]]
name = "pose"
keys = ["robot/*/pose"]
utility = { kind = "linear", slope = 0.5 }
"""


def write(folder: Path, **files: str) -> Path:
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / f"{name}.toml").write_text(text)
    return folder


def messages(*paths: Path) -> list[str]:
    with pytest.raises(SpecsError) as caught:
        load_set(paths)
    return [str(problem) for problem in caught.value.problems]


def test_the_good_spec_is_loaded_whole(tmp_path):
    """Every key arrives where the daemon looks for it."""
    specs = load_specs(write(tmp_path, good=GOOD) / "good.toml")
    (camera,), (constraint,) = specs.types, specs.constraints
    assert (camera.name, camera.keys) == ("camera", ("robot/*/camera",))
    assert (camera.aggregation, camera.weight, camera.utility) == (Aggregation.MOST_RECENT, 1.0, Video())
    assert camera.scale({"red": 0.25}) == 3.5
    assert camera.forecast.plain
    assert (constraint.name, constraint.measure) == ("throughput", Throughput(250_000.0, 0.5))


def test_what_is_not_written_has_its_default(tmp_path):
    """A type needs a name, keys and a utility; half a second is the window; there may be no constraint."""
    specs = load_specs(write(tmp_path, short=SECOND + '[[constraint]]\nkind = "throughput"\nlimit = "1 kB/s"\n'))
    (pose,) = specs.types
    assert (pose.weight, pose.scale({}), pose.needs_payload, pose.utility) == (
        1.0,
        1.0,
        False,
        Linear(1.0, 0.5),
    )
    assert specs.constraints[0].measure.window == 0.5
    assert load_specs(write(tmp_path, short=SECOND)).constraints == ()


def test_a_folder_is_one_set_of_all_its_files_by_name(tmp_path):
    """Types and constraints of all `*.toml` add up by the names of the files; others are left alone."""
    folder = write(tmp_path, b=GOOD, a=SECOND, c='[[constraint]]\nkind = "throughput"\nlimit = "1 kB/s"\n')
    (folder / "README.md").write_text("not a spec")
    (folder / ".#a.toml").symlink_to("user@host.1234:1")
    (folder / "._a.toml").write_bytes(b"\x00\x05\x16\x07")
    specs = load_specs(folder)
    assert [each.name for each in specs.types] == ["pose", "camera"]
    assert [each.name for each in specs.constraints] == ["throughput", "throughput 2"]


def test_constraints_of_all_kinds_stand_side_by_side(tmp_path):
    """Each becomes the planner's measure, in bytes, seconds and joules, with its defaults."""
    kinds = """\
        [[constraint]]
        kind = "messages"
        limit = 10
        [[constraint]]
        kind = "airtime"
        limit = "40 %"
        rate = "8 Mbit/s"
        window = 1
        wifi = "infrastructure"
        hops = 2
        [[constraint]]
        kind = "airtime"
        limit = 0.5
        rate = "1 Gbit/s"
        wifi = "wired"
        [[constraint]]
        kind = "airtime"
        name = "radio"
        limit = 1
        rate = "11 Mbit/s"
        cast = "multicast"
        multicast_rate = "2 Mbit/s"
        overhead = "0.8 ms"
        [[constraint]]
        kind = "energy"
        limit = "1 mWh"
        window = "10 s"
        per_byte = "2 uJ"
        [[constraint]]
        kind = "energy"
        name = "radio energy"
        limit = "0.5 J"
        per_message = "1 mJ"
    """
    specs = load_specs(write(tmp_path, a=GOOD, b=kinds))
    assert [(each.name, each.measure) for each in specs.constraints] == [
        ("throughput", Throughput(250_000.0)),
        ("messages", Messages(10)),
        ("airtime", Airtime(0.4, 1e6, 1.0, wifi="infrastructure", hops=2)),
        ("airtime 2", Airtime(0.5, 125e6, wifi="wired", overhead=0.0)),
        ("radio", Airtime(1.0, 1_375_000.0, cast="multicast", multicast_rate=250_000.0, overhead=800e-6)),
        ("energy", Energy(3.6, 10.0, per_byte=2e-6)),
        ("radio energy", Energy(0.5, per_message=1e-3)),
    ]


def test_a_nameless_constraint_avoids_names_that_are_taken(tmp_path):
    """Made-up names never meet given ones."""
    one = '[[constraint]]\nkind = "throughput"\nlimit = "1 kB/s"\n'
    specs = load_specs(write(tmp_path, a=SECOND + one + 'name = "throughput"\n' + one))
    assert [each.name for each in specs.constraints] == ["throughput", "throughput 2"]


def test_a_file_that_is_named_twice_counts_once(tmp_path):
    """A folder and a file in it, or a link to it, are no duplicates."""
    folder = write(tmp_path, a=SECOND)
    (folder / "b.toml").symlink_to(folder / "a.toml")
    assert len(load_set([folder, folder / "a.toml"]).files) == 1


def test_the_generation_tells_specs_apart_by_what_they_say(tmp_path):
    """Comments, layout and file names do not matter; every value does."""
    plain = load_specs(write(tmp_path / "plain", a=GOOD)).generation
    commented = "# the same\n" + GOOD.replace("window = 0.5", 'window = "500 ms"')
    assert load_specs(write(tmp_path / "same", z=commented)).generation == plain
    assert load_specs(write(tmp_path / "other", a=GOOD.replace("1 + 10", "1 + 11"))).generation != plain
    assert len(plain) == 12


@pytest.mark.parametrize("spec", BROKEN, ids=lambda spec: spec.wrong[:40] or spec.right[:40])
def test_each_broken_spec_is_refused_with_all_that_is_wrong_with_it(tmp_path, spec: Bad):
    """File, line, key and what to write instead, for every mistake."""
    path = write(tmp_path, bad=spec.text) / "bad.toml"
    assert messages(path) == [f"{path}{message.replace('FILE', str(path))}" for message in spec.messages]


def test_the_corpus_is_large_enough():
    """There are many ways to get a spec wrong."""
    assert len({spec.text for spec in BROKEN}) == len(BROKEN) >= 300


def test_all_files_are_judged_even_when_one_is_not_toml(tmp_path):
    """Problems of all files come at once, file by file, repeated names across files included."""
    folder = write(tmp_path, a="x =", b=GOOD.replace("1.0", "-1"), c=GOOD)
    again = f'"camera" is already the name of the one at {folder}/b.toml:7'
    assert messages(folder) == [
        f"{folder}/a.toml:1: not valid TOML: Invalid value at the end of the file",
        f'{folder}/b.toml:10: information_type "camera": weight: must be at least 0, not -1',
        f'{folder}/c.toml:7: information_type "camera": name: {again}',
    ]


def test_places_without_specs_are_refused_by_name(tmp_path):
    """A missing file, an empty folder, a folder that is called like a file, circular links."""
    (tmp_path / "empty").mkdir()
    write(tmp_path / "odd", a=SECOND)
    (tmp_path / "odd" / "b.toml").mkdir()
    (tmp_path / "circle.toml").symlink_to(tmp_path / "circle.toml")
    assert messages(tmp_path / "none.toml") == [f"{tmp_path}/none.toml: does not exist"]
    assert messages(tmp_path / "empty") == [f"{tmp_path}/empty: has no *.toml file in it"]
    assert messages(tmp_path / "odd") == [f"{tmp_path}/odd/b.toml: is not a file"]
    assert "cannot be read" in messages(tmp_path / "circle.toml")[0]
    assert "cannot be read" in messages(Path("a\0b"))[0]


def test_files_without_any_information_type_are_refused(tmp_path):
    """Limits alone decide nothing."""
    folder = write(tmp_path, a="", b='[[constraint]]\nkind = "throughput"\nlimit = "1 kB/s"\n')
    assert messages(folder) == [f"{folder}: information_type: is missing; a spec needs at least one"]


SCRAPS = [
    b"[[information_type]]",
    b"[[",
    b"]",
    b"=",
    b'"',
    b"'''",
    b"\n",
    b"nan",
    b"[]",
    b"{}",
    b"1e999",
    b"\xff",
]
SCRAPS += [
    b"name",
    b"keys",
    b"scale",
    b"utility",
    b".",
    b"red",
    b"\0",
    b"true",
    b"-1",
    b"#",
    b"kind",
    b", ",
    b"(",
]


@st.composite
def mangled(draw) -> bytes:
    """The good spec with some places replaced by scraps."""
    raw = GOOD.encode()
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(raw)))
        length = draw(st.integers(0, 12))
        raw = raw[:start] + b"".join(draw(st.lists(st.sampled_from(SCRAPS), max_size=3))) + raw[start + length :]
    return raw


@given(mangled() | st.binary(max_size=100))
def test_any_bytes_are_either_specs_or_refused(tmp_path_factory, raw):
    """The loader raises nothing but SpecsError, and what it loads can be used."""
    path = tmp_path_factory.getbasetemp() / "any-spec.toml"
    path.write_bytes(raw)
    with suppress(SpecsError):
        for each in load_specs(path).types:
            assert each.scale({}) >= 0.0
