"""The files of the configuration: which there are, what they say together, and where."""

from pathlib import Path

import pytest

from proxy import config_files
from proxy.config_files import ConfigFiles, standard, watched


@pytest.fixture
def write(tmp_path):
    """Write files beside each other; return what is read of them."""

    def written(**texts):
        (tmp_path / "conf.d").mkdir(exist_ok=True)
        for name, text in texts.items():
            place = tmp_path / "sendworthy.toml" if name == "main" else tmp_path / "conf.d" / f"{name}.toml"
            place.write_text(text)
        return ConfigFiles.read(tmp_path / "sendworthy.toml")

    return written


def place(files, path):
    """Name the file and the line of a key."""
    found = files.line_of(path, files.values)
    return found and f"{found[0].name}:{found[1]}"


def test_files_of_the_folder_are_laid_upon_the_main_one_by_name(write):
    """Table by table; of a list the last file has all."""
    files = write(
        b="[mesh]\nconnect = ['b']\nallowance = 0.2\n",
        a="[mesh]\nallowance = 0.1\nscouting = false\n",
        main="robot = 'r1'\n[mesh]\nconnect = ['x', 'y']\nallowance = 0.3\n",
    )
    assert [source.path.name for source in files.sources] == ["sendworthy.toml", "a.toml", "b.toml"]
    assert files.values == {"robot": "r1", "mesh": {"connect": ["b"], "allowance": 0.2, "scouting": False}}
    assert place(files, ("robot",)) == "sendworthy.toml:1"
    assert place(files, ("mesh", "scouting")) == "a.toml:3"
    assert place(files, ("mesh", "allowance")) == "b.toml:3"
    assert place(files, ("mesh", "connect", 0)) == "b.toml:2"
    assert place(files, ("mesh", "group")) is None


def test_a_table_that_stands_where_another_file_has_none_is_no_ones_place(write):
    """The mistake is the value, in whichever file it is."""
    files = write(main="app = true\n", a="[app]\nscouting = true\n")
    assert files.values == {"app": True}
    assert place(files, ("app",)) == "sendworthy.toml:1"
    files = write(main="[app]\nscouting = true\n", a="\napp = true\n")
    assert place(files, ("app",)) == "a.toml:2"


def test_a_problem_is_shown_where_its_table_is_if_nobody_wrote_the_key(write):
    """In the last file that has the table."""
    files = write(main="[mesh]\n[app]\n", a="# more\n[mesh]\nscouting = true\n")
    problem = files.problem(("mesh", "connect"), "is missing", files.values)
    assert (problem.file.name, problem.line, problem.key) == ("a.toml", 2, "mesh.connect")


def test_files_that_cannot_be_read_are_named_and_count_as_empty(write, tmp_path):
    """The others are read all the same."""
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "z.toml").symlink_to("gone")
    files = write(main="robot = 'r1'\n", a="robot = \n")
    assert files.values == {"robot": "r1"}
    assert [(problem.file.name, problem.line) for problem in files.unread] == [("a.toml", 1), ("z.toml", None)]


def test_what_is_no_folder_or_no_toml_is_not_read(tmp_path):
    """Such as what editors and packages leave behind."""
    (tmp_path / "sendworthy.toml").write_text("robot = 'r1'\n")
    (tmp_path / "conf.d").write_text("= nonsense")
    assert len(ConfigFiles.read(tmp_path / "sendworthy.toml").sources) == 1
    (tmp_path / "conf.d").unlink()
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "a.toml.dpkg-dist").write_text("= nonsense")
    (tmp_path / "conf.d" / ".#a.toml").symlink_to("user@host.1234:1")
    assert ConfigFiles.read(tmp_path / "sendworthy.toml").unread == ()


def test_without_a_main_file_there_is_none_at_all(tmp_path, monkeypatch):
    """Also not what happens to be in the working directory."""
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "a.toml").write_text("robot = 'r1'\n")
    monkeypatch.chdir(tmp_path)
    assert ConfigFiles.read(None).values == {}


def test_the_standard_file_is_taken_where_it_is_and_no_other_was_given(tmp_path, monkeypatch):
    """A robot has it in /etc."""
    assert Path("/etc/sendworthy/sendworthy.toml") == config_files.STANDARD
    monkeypatch.setattr(config_files, "STANDARD", tmp_path / "sendworthy.toml")
    assert standard(None) is None
    (tmp_path / "sendworthy.toml").touch()
    assert standard(None) == tmp_path / "sendworthy.toml"
    assert standard(Path("other.toml")) == Path("other.toml")


def test_the_main_file_and_the_folder_are_watched():
    """Also while there is no such folder."""
    assert list(watched(Path("/etc/a.toml"))) == [Path("/etc/a.toml"), Path("/etc/conf.d")]
