"""The page, its figures and its words."""

import json
import re
from dataclasses import replace
from datetime import UTC, datetime

import cv2
import pytest

from studies.study.contenders import BOUND
from studies.study.figures import sweep_figure
from studies.study.page import write
from studies.study.programme import QUICK, sweeps
from studies.study.results import Results
from studies.study.store import Store
from tests.studies.study.records import filled

pytestmark = pytest.mark.full

NOW = datetime(2026, 1, 2, 3, 4, tzinfo=UTC)
REACHED = {"best": 48.0, BOUND: 50.0, "random": 20.0}


def reached(task):
    """Best mode reaches 96 % of the bound, others 80 %; random dropping much less than that."""
    if task.network == "own":
        return {"utility": 46.0}
    return {"utility": REACHED.get(task.contender, 40.0), "sent": int(100 * task.level) if task.level < 1 else 20}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A page of the quick study."""
    folder = tmp_path_factory.mktemp("page")
    store = filled(folder / "records.jsonl", QUICK, reached)
    write(Results(store), QUICK, folder / "RESULTS.md", NOW)
    return folder


def test_the_page_says_what_was_flown_and_when(folder):
    """And that it is not all of it."""
    text = (folder / "RESULTS.md").read_text()
    assert "(quick) on 2026-01-02 03:04 UTC" in text
    assert "This is not the full study" in text
    assert "not flown yet" not in text


def test_words_are_those_of_the_figures(folder):
    """Shares, differences and what agrees."""
    text = (folder / "RESULTS.md").read_text()
    assert "best mode reaches 95 % of the bound at 2 of the 2 limits" in text
    assert "| 2     |      96.0 |" in text
    assert "points ahead by the mean of 2 limits that bind" in text
    assert "+16.0 points ahead" in text
    assert "-4.0 points over our own medium" in text
    assert "at 0 of 3 points where the channel is not saturated" in text


def test_real_traffic_stands_beside_what_does_not_plan(folder):
    """By network, with what became of small samples and what it takes."""
    text = (folder / "RESULTS.md").read_text()
    assert "By broadcast, ad hoc best mode reaches 96.0 % of the bound in *random* (paper mode 80.0" in text
    (row,) = [
        line for line in text.splitlines() if line.startswith("| random, 5 robots: best mode") and "ad hoc" in line
    ]
    cells = [cell.strip() for cell in row.split("|")[2:-1]]
    assert cells == ["ad hoc", "96.0", "0.0", "1.00", "99.0", "1.0 / 2.0", "1 / 5", "10.0"]


def test_what_decisions_take_stands_beside_utility(folder):
    """As data, too: that of a flight, by robot and second."""
    spent = json.loads((folder / "results" / "study.json").read_text())["spent"]["loss"]["best mode"]
    assert [(each["decision"], each["processor"]) for each in spent] == [([0.001, 0.005], 0.02)] * 2


def test_every_figure_is_there(folder):
    """As PNG and SVG, and nothing else than what the page shows."""
    named = set(re.findall(r"results/([\w.-]+)\)", (folder / "RESULTS.md").read_text()))
    written = {path.name for path in (folder / "results").iterdir()} - {"study.json"}
    assert named == written
    assert len(written) == 2 * (3 + len(sweeps(QUICK)))
    for path in (folder / "results").glob("*.png"):
        assert cv2.imread(str(path)).std() > 1.0


def test_a_logarithmic_axis_may_begin_at_nothing(tmp_path):
    """No iterations stand left of one, then come decades."""
    extent = replace(QUICK, sweeps=("iterations",), points=100)
    results = Results(filled(tmp_path / "records.jsonl", extent, reached))
    name = sweep_figure(results, extent, sweeps(extent)[0], tmp_path)
    ticks = re.findall(r">(\d+)</text>", (tmp_path / f"{name}.svg").read_text())
    axis = ["0", "1", "10", "30", "100", "300", "1000", "3000", "10000"]
    assert axis in [ticks[k : k + len(axis)] for k in range(len(ticks))]


def test_all_figures_are_there_as_data(folder):
    """With what is known of their confidence."""
    data = json.loads((folder / "results" / "study.json").read_text())
    assert data["extent"] == "quick"
    (first, _) = data["scenarios"]["mixed"]["of_bound"]["best"]
    assert first == {"limit": 2.0, "mean": 0.96, "half": None, "missions": 1}


def test_the_same_results_make_the_same_files(folder, tmp_path):
    """To the byte."""
    write(Results(Store(folder / "records.jsonl")), QUICK, tmp_path / "RESULTS.md", NOW)
    for path in (folder / "results").iterdir():
        assert (tmp_path / "results" / path.name).read_bytes() == path.read_bytes()


def test_a_study_that_is_not_over_says_so(tmp_path):
    """With what there is."""
    write(Results(Store(tmp_path / "records.jsonl")), replace(QUICK, sweeps=()), tmp_path / "RESULTS.md", NOW)
    assert "are not flown yet" in (tmp_path / "RESULTS.md").read_text()
