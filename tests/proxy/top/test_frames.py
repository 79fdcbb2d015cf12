"""What stands on the screen."""

import copy

import pytest

from proxy.status.columns import width_of
from proxy.status.text import SHADOWED
from proxy.top.frames import Scene, frame
from proxy.top.rates import Change
from proxy.top.view import View
from tests.proxy.top.statuses import R1, R2, later
from utility_specs import Specs

SCENE = Scene({R1["zid"]: Change(R1).then(later(R1))})


def lines(view=None, width=80, height=24, scene=SCENE):
    return [line.text for line in frame(scene, view or View(), width, height)]


def shown(*arguments, **options):
    return "\n".join(lines(*arguments, **options))


def test_a_robot_at_80_columns():
    """How full the channel is, what room costs, what becomes of samples and why, the planner, streams and peers."""
    limit = R1["budget"][0]
    text = lines()
    assert text[0].startswith("robot r1   mode enforce   sendworthy ")
    assert text[1].startswith("throughput  [##########  ] 85% of 91.9 kB in 0.5 s, ours ")
    assert text[1].endswith(f"; 1 kB costs {limit['price_per_kb']:.3g}")
    assert text[2] == "samples   30.0/s made, 18.0/s sent, 12.0/s dropped: planner 10.0, constraint"
    assert text[4] == "planner   5.0 decisions/s, 5 ms each, 2% of a core, 0.0/s late"
    assert text[6].split() == ["STREAM", "MADE/S", "SENT/S", "NOT", "SENT", "AGE", "WANTED", "BY", "DROPPED", "BECAUSE"]
    assert text[7].split()[:4] == ["robot/r1/alarm", "10.0", "6.0", "4.0"]
    assert text[7].endswith("planner 4")
    assert "PEER  MODE     VERSION" in shown()
    assert text[-1].startswith("by not sent   q quit  ? help")


@pytest.mark.parametrize("width", [80, 100, 160])
@pytest.mark.parametrize("height", [12, 24, 50])
@pytest.mark.parametrize("view", [View(), View(fleet=True), View(help=True), View(all_streams=True), View(robot="r3")])
def test_every_screen_fits_the_terminal(view, width, height):
    """And fills it."""
    found = lines(copy.copy(view), width, height)
    assert len(found) == height
    assert max(map(width_of, found)) <= width


def test_tiny_terminals_show_what_they_can():
    """Nothing fails."""
    for width, height in ((20, 3), (10, 1), (44, 8)):
        assert len(lines(View(), width, height)) == height
        assert len(lines(View(fleet=True), width, height)) == height


def test_the_fleet_has_a_row_for_each_robot():
    """With what it sends, how old it is, and how far away; the marked one stands out."""
    found = frame(SCENE, View(fleet=True, at=1), 160, 30)
    text = [line.text for line in found]
    assert text[0] == "3 robots"
    assert text[2].split()[:3] == ["ROBOT", "MODE", "VERSION"]
    assert [line.split()[0] for line in text[3:6]] == ["r1", "r2", "r3"]
    assert [line.style == "reverse" for line in found[3:6]] == [False, True, False]


def test_in_a_fleet_that_is_larger_than_the_screen_the_marked_robot_is_seen():
    """Whichever it is."""
    peers = [R1["peers"][0] | {"robot": f"x{number:02}", "zid": f"{number:032x}"} for number in range(60)]
    scene = Scene({R1["zid"]: Change(R1 | {"peers": peers})})
    view = View(fleet=True)
    for key, name in (("end", "x59"), ("home", "r1")):
        view.press(key)
        marked = [line.text for line in frame(scene, view, 80, 24) if line.style == "reverse"]
        assert [text.split()[0] for text in marked] == [name]


def test_a_robot_that_does_not_answer_is_shown_as_another_one_sees_it():
    """Its streams, and how it is reached."""
    text = shown(View(robot="r2"))
    assert text.startswith("robot r2   mode enforce   version ")
    assert "as robot r1 sees it" in text
    assert "robot/r2/camera" in text
    assert "robot/r1/camera" not in text
    assert "samples" not in text


def test_streams_of_all_robots_scroll():
    """And how many more there are is said."""
    view = View(all_streams=True)
    before = shown(view, height=16)
    assert "… and " in before
    view.press("end")
    after = shown(view, height=16)
    assert after != before
    assert "… and " not in after


def test_a_filter_is_seen_while_it_is_typed_and_after():
    """Only rows with it are there."""
    text = shown(View(all_streams=True, filter="camera", typing=True))
    assert "only rows with: camera_" in text
    assert "alarm" not in text
    assert "only 'camera'" in shown(View(filter="camera"))


def test_a_daemon_that_is_away_is_named_and_its_last_words_stay():
    """Or there are none yet."""
    away = "no daemon answers at tcp/127.0.0.1:7447"
    text = shown(scene=Scene(SCENE.changes, away))
    assert text.startswith(f"{away}; what is shown is what it said last")
    assert "robot/r1/camera" in text
    assert lines(scene=Scene({}, away))[0] == away
    assert lines(scene=Scene({}))[0] == "asking …"


def test_a_robot_that_nobody_knows_is_named():
    """With those that there are."""
    view = View(robot="zz")
    assert "robot zz is not known; there are r1, r2, r3" in shown(view)
    assert view.found is False


def test_two_robots_of_one_name_are_told_apart():
    """And that it is so is said first."""
    other = R2 | {"robot": "r1", "zid": "beef", "peers": []}
    text = shown(View(fleet=True), 160, scene=Scene({R1["zid"]: Change(R1), "beef": Change(other)}))
    assert "warning: several robots are called r1: rename all but one" in text
    assert "r1 (beef)" in text


def test_what_is_wrong_comes_first():
    """Three things; how many more there are is said."""
    scene = Scene({R1["zid"]: Change(R1 | {"warnings": ["a", "b", "c", "d"]})})
    assert lines(scene=scene)[1:5] == [
        "warning: a",
        "warning: b",
        "warning: c",
        "and 1 more warnings: see sendworthy status",
    ]


def test_a_robot_without_specs_says_that_everything_passes():
    """Else nobody would see why nothing is decided."""
    bare = R1 | {"specs": Specs.empty().generation, "daemon": {"specs": "/etc/specs.d"}}
    scene = Scene({R1["zid"]: Change(bare)})
    assert lines(scene=scene)[1] == "no specs in /etc/specs.d: everything passes"
    assert shown(width=200, scene=scene).count("everything passes") == 1


def test_a_robot_that_is_alone_says_so():
    """In place of a table of nobody."""
    text = lines(scene=Scene({R1["zid"]: Change(R1 | {"peers": []})}))
    assert "no other robot is on the mesh; samples that nobody there wants stay here and are" in text


def test_a_robot_that_takes_no_part_stands_out():
    """As does a full limit."""
    peers = [R1["peers"][0] | {"takes_part": False}]
    budget = [R1["budget"][0] | {"used_by_all": R1["budget"][0]["limit"]}]
    found = frame(Scene({R1["zid"]: Change(R1 | {"peers": peers, "budget": budget})}), View(), 80, 24)
    loud = [line.text for line in found if line.style == "bold red"]
    assert loud[0].startswith("throughput  [############] 100%")
    assert "takes no part" in loud[1]


def test_help_names_keys_and_columns():
    """And scrolls where it has no room."""
    view = View(help=True)
    text = "\n".join(line.text for line in frame(SCENE, view, 80, None))
    for word in ("quit", "sort by", "DROPPED BECAUSE", "OLDEST"):
        assert word in text
    view.press("end")
    assert "SEEN BY" in shown(view)


def test_a_status_of_another_version_is_shown_as_far_as_it_goes():
    """What is missing is a dash."""
    scene = Scene(
        {"a": Change({"robot": "r9", "zid": "a", "budget": [{}], "peers": [{}], "streams": [{"robot": "r9"}]})}
    )
    assert shown(scene=scene).startswith("robot r9   mode -")
    assert "r9" in shown(View(fleet=True), scene=scene)


def test_what_is_wrong_is_shown_whole():
    """In as many lines as that takes: the middle may be what matters."""
    said = "this robot is in shadow and all of the others, which are r2 and r3 and r4, give way to it; put all in one"
    wrong = R1 | {"warnings": [f"{said} mode"]}
    text = " ".join(line.strip() for line in lines(scene=Scene({R1["zid"]: Change(wrong)})))
    assert f"warning: {said} mode" in text


def test_in_shadow_it_is_said_that_all_samples_go():
    """What is not sent of a stream is what enforce would not send."""
    assert SHADOWED in lines(scene=Scene({R1["zid"]: Change(R1 | {"mode": "shadow"})}))
    assert SHADOWED not in lines()


@pytest.mark.parametrize("used", [float("nan"), float("inf"), -1.0, 1e300])
def test_a_limit_that_is_no_sense_is_drawn_all_the_same(used):
    """Any application may answer as a daemon does."""
    status = copy.deepcopy(R1)
    status["budget"][0]["used_by_all"] = used
    lines = frame(Scene({"a": Change(status)}, ""), View(), 120)
    assert any(f"{status['budget'][0]['constraint']}  [" in line.text for line in lines)
