"""The flame graph of a profile."""

import pytest

from proxy.profiling.flame import MARGIN, ROW, WIDTH, flame
from proxy.profiling.profile import Branch
from tests.proxy.profiling.profiles import picture_of, profile

SVG = "{http://www.w3.org/2000/svg}"


def boxes(text):
    """The boxes by the name in their titles: x, y and width."""
    found = {}
    for group in picture_of(text).iter(f"{SVG}g"):
        rect = group.find(f"{SVG}rect")
        name = group.find(f"{SVG}title").text.partition(": ")[0]
        found[name] = tuple(float(rect.get(of)) for of in ("x", "y", "width"))
    return found


def test_boxes_are_as_wide_as_the_time_that_was_spent():
    """And stand on who called them."""
    found = boxes(flame(profile()))
    x, bottom, width = found["all"]
    assert (x, width) == (MARGIN, pytest.approx(WIDTH - 2 * MARGIN))
    for name, part, level in (
        *(("planner", 0.5, 1), ("Worker._run (proxy.worker)", 0.5, 2), ("decide <&> (proxy.worker)", 0.5, 3)),
        *(("loop", 0.25, 1), ("zenoh rx", 0.25, 1)),
    ):
        _, y, wide = found[name]
        assert wide == pytest.approx(part * width, abs=0.01)
        assert y == bottom - level * ROW
    assert found["planner"][0] == found["decide <&> (proxy.worker)"][0] == found["loop"][0] + found["loop"][2]
    assert all(x + wide <= WIDTH - MARGIN + 0.01 and y >= 0.0 for x, y, wide in found.values())


def test_hovering_tells_what_a_box_is():
    """Its time, and the stage for which it was spent."""
    titles = [title.text for title in picture_of(flame(profile())).iter(f"{SVG}title")]
    assert "loop: 250.0 ms, 12.50% of a core, core" in titles


def test_the_head_names_the_stages():
    """And what was measured."""
    texts = [text.text for text in picture_of(flame(profile())).iter(f"{SVG}text")]
    assert texts[0] == "Processor time of r1: 1.00 s in 2.0 s, 20.00 ms for each of 50 samples"
    assert texts[1:4] == ["core 25%", "search 50%", "zenoh 25%"]


def test_what_is_too_narrow_is_left_out_and_names_are_cut():
    """No letter stands beyond its box."""
    narrow = Branch("core", ("loop", "narrow"), 0.0001)
    wide = Branch("core", ("loop", "wide" * 100), 1.0)
    text = flame(profile(narrow, wide))
    assert "narrow" not in boxes(text)
    (cut,) = [each.text for each in picture_of(text).iter(f"{SVG}text") if each.text.startswith("widewide")]
    assert cut.endswith("…")
    assert len(cut) < 200


def test_an_empty_profile_is_a_picture_too():
    """Of nothing."""
    assert boxes(flame(profile(Branch("core", ("loop",), 0.0)))) == {}
