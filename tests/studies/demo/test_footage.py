"""Footage of one's own."""

import cv2
import numpy as np
import pytest

from studies.demo.footage import Footage, find_footage, open_footage, share
from studies.demo.processes import DemoError
from studies.demo.scene import HEIGHT, WIDTH

GREY, RED = (90, 90, 90), (20, 20, 220)


def still(path, colour, size=(120, 160)):
    """Write an image of one colour."""
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), np.full((*size, 3), colour, np.uint8))


def video(path, colours, rate=10.0):
    """Write a video, a frame of each colour."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), rate, (160, 120))
    assert writer.isOpened()
    for colour in colours:
        writer.write(np.full((120, 160, 3), colour, np.uint8))
    writer.release()


def reds(footage, count):
    """Which frames are red."""
    film = open_footage(footage)
    found = [film.frame(number).red for number in range(count)]
    film.close()
    assert all(red == pytest.approx(0.0) or red == pytest.approx(1.0) for red in found)
    return [round(red) for red in found]


def test_a_folder_of_images_is_replayed_again_and_again(tmp_path):
    """In the order of the names, as large as a camera's frames."""
    still(tmp_path / "1.png", GREY)
    still(tmp_path / "2.jpg", RED)
    still(tmp_path / "3.png", GREY)
    assert reds(Footage(tmp_path), 6) == [0, 1, 0, 0, 1, 0]
    jpeg = open_footage(Footage(tmp_path)).frame(0).jpeg
    assert cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR).shape == (HEIGHT, WIDTH, 3)


def test_a_video_is_replayed_at_its_own_pace(tmp_path):
    """Of twenty frames a second every other one is due."""
    video(tmp_path / "fast.avi", [GREY, GREY, RED, RED, GREY, GREY], rate=20.0)
    assert sum(reds(Footage(tmp_path / "fast.avi"), 6)) == 2


def test_each_folder_and_video_is_a_robots(tmp_path):
    """In the order of their names; robots that share one begin at different places."""
    still(tmp_path / "b" / "1.png", GREY)
    video(tmp_path / "a.avi", [RED, GREY])
    found = find_footage(tmp_path)
    assert [each.name for each in found] == ["a.avi", "b"]
    assert share(found, 4) == [
        Footage(found[0]),
        Footage(found[1]),
        Footage(found[0], 0.5),
        Footage(found[1], 0.5),
    ]


def test_images_alone_are_shared_by_all(tmp_path):
    """The second of two robots begins in the middle."""
    for number, colour in enumerate((GREY, GREY, RED, RED)):
        still(tmp_path / f"{number}.png", colour)
    one, two = share(find_footage(tmp_path), 2)
    assert reds(one, 4) == [0, 0, 1, 1]
    assert reds(two, 4) == [1, 1, 0, 0]


def test_what_is_no_footage_is_named(tmp_path):
    """The file, and what is wrong with it."""
    with pytest.raises(DemoError, match=r"--footage .*nowhere: there is no such folder"):
        find_footage(tmp_path / "nowhere")
    with pytest.raises(DemoError, match="the folder is empty"):
        find_footage(tmp_path)
    (tmp_path / "r1").mkdir()
    still(tmp_path / "r1" / "1.png", GREY)
    (tmp_path / "r1" / "2.png").write_text("no image")
    with pytest.raises(DemoError, match=r"--footage .*r1/2.png: not an image"):
        find_footage(tmp_path)
    (tmp_path / "r1" / "2.png").unlink()
    (tmp_path / "r2.mp4").write_bytes(b"no video")
    with pytest.raises(DemoError, match=r"--footage .*r2.mp4: not a video that OpenCV can read"):
        find_footage(tmp_path)
    (tmp_path / "r2.mp4").rename(tmp_path / "notes.txt")
    with pytest.raises(DemoError, match=r"--footage .*notes.txt: neither a folder of images nor a video"):
        find_footage(tmp_path)


def test_an_image_that_is_cut_short_is_named_when_its_turn_comes(tmp_path):
    """Looking at all of them takes too long at the start."""
    still(tmp_path / "1.png", GREY)
    whole = (tmp_path / "1.png").read_bytes()
    (tmp_path / "2.png").write_bytes(whole[: len(whole) // 2])
    film = open_footage(Footage(tmp_path))
    film.frame(0)
    with pytest.raises(DemoError, match=r"2.png: the image is broken"):
        film.frame(1)


def test_an_image_of_another_shape_is_not_stretched(tmp_path):
    """A square fills three quarters of a camera's frame."""
    still(tmp_path / "1.png", RED, size=(100, 100))
    assert open_footage(Footage(tmp_path)).frame(0).red == pytest.approx(0.75, abs=0.01)
