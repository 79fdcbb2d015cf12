"""Files that change while a daemon runs, without the daemon."""

from functools import partial

import pytest

from proxy.config_files import watched
from proxy.config_loading import load_config
from proxy.reloading import Loaded, Reloading, read_specs
from proxy.watching import signature
from tests.utility_specs.models import Hiding
from utility_specs import SpecsError

CONFIG = 'robot = "r1"\nmode = "enforce"\n'
SPECS = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
weight = 1.0
utility = { kind = "video" }
"""


class Files:
    """A configuration and its specs, and what was put in force of them."""

    def __init__(self, folder):
        self.config, self.specs = folder / "sendworthy.toml", folder / "specs.d" / "camera.toml"
        self.specs.parent.mkdir()
        self.config.write_text(CONFIG)
        self.specs.write_text(SPECS)
        self.applied = []
        read = partial(load_config, self.config, {}, {})
        loaded = Loaded(read(), read_specs(read().specs.path))
        self.reloading = Reloading(loaded, self.config, read, self._apply)

    def _apply(self, loaded, changed):
        self.applied.append((loaded.specs.types[0].scale({}), [".".join(change.path) for change in changed]))

    @property
    def weight(self):
        return self.reloading.loaded.specs.types[0].scale({})

    def looked(self):
        """Look until a change would have been noticed."""
        for _ in range(2):
            self.reloading.look()
        return self.reloading.describe()


@pytest.fixture
def files(tmp_path):
    return Files(tmp_path)


def test_changed_specs_are_put_in_force_once(files):
    """Without anybody asking."""
    assert files.looked() == {"done": 0, "refused": 0, "problems": []}
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    assert files.looked() == {"done": 1, "refused": 0, "problems": []}
    assert files.looked()["done"] == 1
    assert files.applied == [(2.0, [])]


def test_a_limit_that_holds_little_beside_digests_is_told(files, caplog):
    """Where the daemon reads it, at its start or later; it is in force."""
    files.specs.write_text('[[constraint]]\nkind = "throughput"\nlimit = "5 kbit/s"\n' + SPECS)
    assert files.looked()["done"] == 1
    assert (
        f'{files.specs.parent}: constraint "throughput": 64 % of it is for what the daemons of 4 robots' in caplog.text
    )


def test_what_says_the_same_changes_nothing(files):
    """A comment is read and nothing else happens."""
    files.specs.write_text("# the camera\n" + SPECS)
    assert files.looked() == {"done": 1, "refused": 0, "problems": []}
    assert not files.applied


def test_what_is_written_as_older_versions_had_it_is_warned_of_when_it_is_new(files, caplog):
    """Once, with its place; it changes nothing that means the same."""
    for text in ("shares", "shares", "split"):
        files.config.write_text(f'{CONFIG}# {len(caplog.records)}\n[planner]\ncoordination = "announce"\n')
        files.looked()
        files.config.write_text(f'{CONFIG}[planner]\n# {text}\ncoordination = "auto"\n')
        files.looked()
    warned = [record.getMessage() for record in caplog.records if record.levelname == "WARNING"]
    assert warned == [f'{files.config}:5: planner.coordination: "auto" is called "announce" now: please write that'] * 3
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    files.looked()
    assert len([record for record in caplog.records if record.levelname == "WARNING"]) == 3
    assert files.reloading.describe()["refused"] == 0


@pytest.mark.parametrize(
    ("broken", "problem"),
    [
        (SPECS.replace("video", "vidoe"), ':6: information_type "camera": utility.kind: unknown'),
        (SPECS[:60], ":4: not valid TOML"),
        ("", ": information_type: is missing"),
        (b"\xff\xfe", ":1: is not UTF-8"),
    ],
)
def test_a_bad_file_changes_nothing_and_is_named(files, caplog, broken, problem):
    """With line and key; the log has it once, and it is tried again when it changes."""
    raw = broken if isinstance(broken, bytes) else broken.encode()
    files.specs.write_bytes(raw)
    state = files.looked()
    assert (state["done"], state["refused"]) == (0, 1)
    assert state["problems"][0].startswith(f"{files.specs}{problem}")
    assert files.reloading.warnings() == [f"the files that changed are not in force: {state['problems'][0]}"]
    assert not files.applied
    files.reloading.reload("SIGHUP")
    assert caplog.text.count("nothing is reloaded") == 1
    files.specs.write_text(SPECS.replace("1.0", "3.0"))
    assert files.looked()["problems"] == []
    assert files.reloading.warnings() == []
    assert files.weight == 3.0


def test_several_mistakes_are_counted_in_the_warning(files):
    """The first is shown; status lists all."""
    files.specs.write_text(SPECS.replace("1.0", '"much"').replace("video", "vidoe"))
    assert len(files.looked()["problems"]) == 2
    assert files.reloading.warnings()[0].endswith(" (and 1 more mistake)")


def test_whatever_fails_changes_nothing(files):
    """Also what nobody foresaw, such as an aggregation that fails when it is looked at."""
    files.specs.write_text(f'{SPECS}aggregation = {{ python = "{Hiding.__module__}:Hiding" }}\n')
    assert files.looked()["problems"] == ["cannot be judged: RuntimeError: one two"]
    assert not files.applied
    files.specs.write_text(SPECS.replace("1.0", "3.0"))
    assert files.looked()["problems"] == []
    assert files.weight == 3.0


def test_a_file_that_cannot_be_read_is_a_bad_one(files):
    """A folder in its place, or a link to nowhere; the last good specs stay."""
    files.specs.unlink()
    files.specs.symlink_to("gone")
    assert files.looked()["problems"] == [f"{files.specs}: does not exist"]
    files.specs.unlink()
    files.specs.mkdir()
    assert files.looked()["problems"] == [f"{files.specs}: is not a file"]
    assert files.weight == 1.0


def test_specs_that_vanish_stay_in_force(files):
    """Nothing to read is not the same as nothing to limit."""
    problem = f"{files.specs.parent}: there are no specs any more; the last ones stay in force"
    files.specs.unlink()
    assert files.looked()["problems"] == [problem]
    files.specs.parent.rmdir()
    assert files.looked()["problems"] == [problem]
    assert files.weight == 1.0


@pytest.mark.parametrize("there", [False, True], ids=["missing", "empty"])
def test_specs_may_come_later(tmp_path, caplog, there):
    """A daemon that started without any, in a folder that is missing or empty, takes them up when they appear."""
    caplog.set_level("INFO")
    folder = tmp_path / "specs.d"
    if there:
        folder.mkdir()
    config = load_config(None, {}, {"specs.path": str(folder)})
    reloading = Reloading(Loaded(config, read_specs(folder)), None, lambda: config, lambda *_: None)
    assert not reloading.loaded.specs.types
    folder.mkdir(exist_ok=True)
    (folder / "README").write_text("Specs go here.")
    for _ in range(2):
        reloading.look()
    assert "no specs" in caplog.text or not caplog.records
    (folder / "camera.toml").write_text(SPECS)
    for _ in range(2):
        reloading.look()
    assert reloading.describe()["problems"] == []
    assert [each.name for each in reloading.loaded.specs.types] == ["camera"]


def test_a_folder_that_nobody_can_look_into_is_a_mistake_not_an_empty_one(tmp_path):
    """Nothing limited for want of a permission would be found out in flight."""
    with pytest.raises(SpecsError, match=r"cannot be read: .*File name too long"):
        read_specs(tmp_path / ("d" * 300))
    (tmp_path / "circle").symlink_to("circle")
    assert not read_specs(tmp_path / "circle").types


def test_the_mode_changes_with_its_file(files):
    """Together with the specs, in one step."""
    files.config.write_text(CONFIG.replace("enforce", "shadow"))
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    assert files.looked()["done"] == 1
    assert files.applied == [(2.0, ["mode"])]


def test_specs_may_move(files):
    """The new place is read, and watched from then on."""
    other = files.specs.parent.parent / "other.toml"
    other.write_text(SPECS.replace("1.0", "4.0"))
    files.config.write_text(CONFIG + '[specs]\npath = "other.toml"\n')
    assert files.looked()["done"] == 1
    other.write_text(SPECS.replace("1.0", "5.0"))
    files.looked()
    assert [weight for weight, _ in files.applied] == [4.0, 5.0]


def test_what_cannot_change_is_refused_by_name_with_both_values(files):
    """With file and line, and nothing else is taken over either."""
    files.config.write_text(CONFIG.replace("enforce", "pass") + '[mesh]\nlisten = ["tcp/0.0.0.0:7501"]\n')
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    (problem,) = files.looked()["problems"]
    assert problem == (
        f'{files.config}:4: mesh.listen: cannot change while the daemon runs: ["tcp/0.0.0.0:7500"] is in force, '
        'not ["tcp/0.0.0.0:7501"]; restart it'
    )
    assert not files.applied


def test_a_key_that_was_removed_is_refused_without_a_line(files):
    """The default is another value, too."""
    files.config.write_text('mode = "enforce"\n')
    (problem,) = files.looked()["problems"]
    assert problem.startswith(f'{files.config}: robot: cannot change while the daemon runs: "r1" is in force, not ')


def test_a_configuration_with_mistakes_changes_nothing(files):
    """Nor do the specs that changed with it."""
    files.config.write_text(CONFIG.replace("enforce", "enforced"))
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    assert files.looked()["problems"][0].startswith(f"{files.config}:2: mode: ")
    files.config.unlink()
    assert files.looked()["problems"] == [f"{files.config}: does not exist"]
    assert not files.applied


def test_a_busy_daemon_is_told_all_the_same(files, monkeypatch, caplog):
    """It does what it was asked when it comes to it."""

    def too_late(*_):
        raise TimeoutError

    monkeypatch.setattr(files.reloading, "_apply", too_late)
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    assert files.looked() == {"done": 1, "refused": 0, "problems": []}
    assert "the daemon is busy and will do it later" in caplog.text


def test_files_of_conf_d_are_taken_up_when_they_come_change_and_go(files):
    """As the main file is; also when there was no such folder before."""
    further = files.config.parent / "conf.d" / "10-mode.toml"
    further.parent.mkdir()
    further.write_text('mode = "shadow"\n')
    assert files.looked() == {"done": 1, "refused": 0, "problems": []}
    assert files.reloading.loaded.config.mode == "shadow"
    further.write_text('mode = "pass"\n')
    assert files.looked()["done"] == 2
    assert files.reloading.loaded.config.mode == "pass"
    further.unlink()
    assert files.looked()["done"] == 3
    assert files.reloading.loaded.config.mode == "enforce"


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ('\nmode = "fast"\n', ':2: mode: unknown "fast"'),
        ("mode =\n", ":1: not valid TOML"),
        ('mode = "pass"\nrobot = "r2"\n', ':2: robot: cannot change while the daemon runs: "r1" is in force, not "r2"'),
    ],
)
def test_a_bad_file_of_conf_d_changes_nothing_and_is_named(files, text, problem):
    """The last good state stays as a whole, whatever else changed meanwhile."""
    further = files.config.parent / "conf.d" / "10-mode.toml"
    further.parent.mkdir()
    further.write_text(text)
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    state = files.looked()
    assert (state["done"], state["refused"]) == (0, 1)
    assert state["problems"][0].startswith(f"{further}{problem}")
    assert (files.reloading.loaded.config.mode, files.weight) == ("enforce", 1.0)
    further.unlink()
    assert files.looked()["problems"] == []
    assert files.weight == 2.0


@pytest.mark.parametrize("what", ["specs", "configuration", "nothing"])
def test_what_changed_since_it_was_read_is_put_in_force(files, what):
    """While sessions are opened, for a third of a second, as where a script starts the service and copies specs."""
    known = signature([*watched(files.config), files.specs.parent])
    read = partial(load_config, files.config, {}, {})
    loaded = Loaded(read(), read_specs(read().specs.path))
    if what == "specs":
        files.specs.write_text(SPECS.replace("1.0", "2.0"))
    elif what == "configuration":
        files.config.write_text(CONFIG.replace("enforce", "shadow"))
    files.reloading = Reloading(loaded, files.config, read, files._apply, known)
    done = files.looked()["done"]
    assert files.applied == {"specs": [(2.0, [])], "configuration": [(1.0, ["mode"])], "nothing": []}[what]
    assert done == len(files.applied)


def test_where_specs_moved_to_is_watched_though_they_are_refused_there(files, tmp_path):
    """The refusal names a file there, which an operator mends."""
    moved = tmp_path / "other.d" / "camera.toml"
    moved.parent.mkdir()
    moved.write_text(SPECS.replace("1.0", "'much'"))
    files.config.write_text(CONFIG + '[specs]\npath = "other.d"\n')
    assert str(moved) in files.looked()["problems"][0]
    moved.write_text(SPECS.replace("1.0", "3.0"))
    assert files.looked()["problems"] == []
    assert files.weight == 3.0


def test_a_token_that_is_mended_is_read(files, tmp_path):
    """It stands in a file of its own."""
    token = tmp_path / "token"
    token.write_text("s" * 40)
    files.config.write_text(CONFIG + '[fleet]\ntoken_file = "token"\n')
    read = partial(load_config, files.config, {}, {})
    files.reloading = Reloading(Loaded(read(), read_specs(read().specs.path)), files.config, read, files._apply)
    token.write_text("short")
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    assert files.looked()["problems"]
    token.write_text("t" * 40)
    assert files.looked()["problems"] == []
    assert files.weight == 2.0


def test_files_that_cannot_be_put_in_force_are_not_said_to_be(files):
    """A fault of the daemon is no success."""

    def broken(*_):
        raise RuntimeError("half of it is in force")

    files.reloading._apply = broken
    files.specs.write_text(SPECS.replace("1.0", "2.0"))
    assert files.looked()["problems"] == ["cannot be judged: RuntimeError: half of it is in force"]
    assert files.weight == 1.0
