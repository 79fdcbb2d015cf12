"""Tables for people."""

from datetime import UTC, datetime

from studies.benchmarks.report import Figure, Picture, Table, machine, write_page

TABLE = Table("Speed", ("search", "rate"), (("paper", "1,500"), ("b", "2")), "A note.")


def test_text_is_aligned():
    """Names to the left, numbers to the right, the note below."""
    assert TABLE.text() == "Speed\n\n  search   rate\n  paper   1,500\n  b           2\n\nA note."


def test_markdown_is_a_table():
    """The page is readable as text, too."""
    expected = [
        "## Speed",
        "",
        "| search |  rate |",
        "|---|--:|",
        "| paper  | 1,500 |",
        "| b      |     2 |",
        "",
        "A note.",
    ]
    assert TABLE.markdown().splitlines() == expected


def test_a_picture_that_is_there_already_goes_beside_its_page(tmp_path):
    """And the page shows it."""
    write_page(tmp_path / "budget.md", "Budget", [TABLE, Picture("Flames", "<svg/>")], datetime(2026, 5, 4, tzinfo=UTC))
    assert "![Flames](budget.svg)" in (tmp_path / "budget.md").read_text()
    assert (tmp_path / "budget.svg").read_text() == "<svg/>"


def test_a_figure_is_drawn_beside_its_page(tmp_path):
    """Shown as PNG, with a link to the SVG."""

    def draw(folder):
        (folder / "nodes.png").write_bytes(b"png")
        return "nodes"

    write_page(tmp_path / "counts.md", "Counts", [Figure("Nodes", draw)], datetime(2026, 5, 4, tzinfo=UTC))
    page = (tmp_path / "counts.md").read_text()
    assert "![Nodes](nodes.png)" in page
    assert "[nodes.svg](nodes.svg)" in page
    assert (tmp_path / "nodes.png").exists()


def test_pages_name_machine_and_date(tmp_path):
    """A figure is worth nothing without them."""
    path = tmp_path / "results" / "speed.md"
    write_page(path, "Speed of it", [TABLE, TABLE], datetime(2026, 5, 4, 3, 2, tzinfo=UTC))
    page = path.read_text()
    assert page.startswith("# Speed of it\n")
    assert "2026-05-04 03:02 UTC" in page
    assert machine() in page
    assert page.count("## Speed") == 2
    assert page.endswith("A note.\n")
