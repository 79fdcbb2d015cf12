"""Traffic from ROS 2 bags."""

import pytest

from studies.foreign.bags import Bag
from studies.foreign.errors import ImportFailedError
from tests.studies.foreign.rosbags_written import write_bag, write_small_chunks
from tests.utility_specs.features.test_cdr import STORE, battery

HASH = STORE.hash_rihs01("sensor_msgs/msg/BatteryState")
KEY = f"0/r1/battery/sensor_msgs::msg::dds_::BatteryState_/{HASH}"


def read(path, **how):
    bag = Bag(path, "turtle", **how)
    return list(bag.samples()), bag.problems


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("single", [True, False])
def test_a_bag_is_one_robot_and_has_the_keys_of_rmw_zenoh(tmp_path, storage, single):
    """The folder or the file in it; each message as it is, at the time when it was recorded."""
    path = write_bag(tmp_path / "bag", storage)
    if single:
        (path,) = (each for each in path.iterdir() if each.suffix != ".yaml")
    found, problems = read(path)
    assert not problems
    assert len(found) == 90
    assert {each.robot for each in found} == {"turtle"}
    assert [each.t_gen for each in found] == pytest.approx([1.7e9 + i // 3 * 0.1 for i in range(90)])
    assert found[0].key == KEY
    assert found[0].payload == battery(1.0)
    assert found[0].size == len(battery(1.0))


def test_a_robot_may_be_a_namespace_and_a_key_the_topic(tmp_path):
    """A topic without a namespace is the bag's robot's."""
    found, _ = read(write_bag(tmp_path / "bag"), by_namespace=True, plain_keys=True)
    assert {(each.robot, each.key) for each in found} == {
        ("r1", "r1/battery"),
        ("r2", "r2/lidar/scan"),
        ("turtle", "point"),
    }
    assert read(tmp_path / "bag", domain=7)[0][0].key.startswith("7/r1/")


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("keep", [0, 50, 1000])
def test_a_bag_of_which_next_to_nothing_is_there_is_refused(tmp_path, storage, keep):
    """With a message, whatever rosbags makes of it."""
    (path,) = (each for each in write_bag(tmp_path / "bag", storage).iterdir() if each.suffix != ".yaml")
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(ImportFailedError, match=r"bag\.\w+ is no ROS 2 bag that can be read: \w"):
        read(path)


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("single", [True, False])
def test_a_bag_that_is_cut_off_is_read_as_far_as_it_goes(tmp_path, storage, single):
    """The file, or the folder that lost its description; one warning says how much is missing."""
    if storage == "mcap":
        folder = write_small_chunks(tmp_path / "bag")
    else:
        folder = write_bag(tmp_path / "bag", storage, messages=200)
        (folder / "metadata.yaml").unlink()
    (path,) = folder.iterdir()
    whole, _ = read(path)
    size = path.stat().st_size
    path.write_bytes(path.read_bytes()[: size // 2])
    found, problems = read(path if single else folder)
    assert 0.2 * len(whole) < len(found) < 0.7 * len(whole)
    assert found == whole[: len(found)]
    (problem,) = problems
    assert problem.startswith(f"{path} ")
    assert f"{size // 2:,}" in problem
    assert f"{len(found):,} messages could be read, up to 2023-11-14 22:" in problem


def test_a_bag_that_lacks_only_its_index_is_read_to_its_end(tmp_path):
    """And a folder without its description: nothing is missing, but something is wrong."""
    folder = write_bag(tmp_path / "bag")
    path = folder / "bag.mcap"
    whole, _ = read(path)
    (folder / "metadata.yaml").unlink()
    found, problems = read(folder)
    assert found == whole
    assert problems == [
        f"{folder} is no whole bag: metadata.yaml is not in it; its files hold {len(whole)} messages all the same"
    ]
    path.write_bytes(path.read_bytes()[:-20])
    found, problems = read(path)
    assert found == whole
    assert "File end magic is invalid; its files hold 90 messages all the same" in problems[0]


@pytest.mark.full
def test_a_bag_that_is_damaged_is_read_up_to_there(tmp_path):
    """And what is wrong is told."""
    path = write_bag(tmp_path / "bag", messages=8000) / "bag.mcap"
    data = bytearray(path.read_bytes())
    at = data.index(battery(1.0 - 70.0))  # message 7,000
    data[at : at + 40_000] = bytes(40_000)
    path.write_bytes(data)
    found, problems = read(path)
    assert 0 < len(found) < 24_000
    assert f"only {len(found):,} of 24,000 messages could be read" in problems[-1]


def test_what_is_no_bag_is_refused(tmp_path):
    """By what is wrong with it."""
    (tmp_path / "text.mcap").write_text("hello")
    (tmp_path / "folder").mkdir()
    (tmp_path / "some.bin").write_bytes(b"x")
    for name, message in (
        ("text.mcap", "File magic is invalid"),
        ("some.bin", "Unrecognized storage format"),
        ("folder", "metadata.yaml is not in it"),
        ("nothing", "nothing does not exist"),
    ):
        with pytest.raises(ImportFailedError, match=message):
            read(tmp_path / name)
    with pytest.raises(ImportFailedError, match="holds no message"):
        read(write_bag(tmp_path / "empty", messages=0))
