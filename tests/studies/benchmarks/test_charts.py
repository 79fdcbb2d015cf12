"""Charts are drawn with what they are told."""

import cv2
import pytest

from studies.benchmarks.charts import Chart, Series

SERIES = (Series("few", (98.0, None, 97.0)), Series("many", (90.0, 91.0, 92.0)))


@pytest.mark.full
@pytest.mark.parametrize("kind", ["bars", "lines"])
@pytest.mark.parametrize("logarithmic", [True, False])
def test_picture_is_drawn(tmp_path, kind, logarithmic):
    """It has both series in their colours, whatever the axes."""
    chart = Chart("Share of all", ("a", "b", "c"), SERIES, "%", kind, target=97.0, least=1.0, logarithmic=logarithmic)
    chart.draw(tmp_path / chart.file_name(), "2026-01-01 on a machine")
    picture = cv2.imread(str(tmp_path / "share-of-all.png"))
    assert picture.shape[0] > 300
    for blue, green, red in ((0xB2, 0x72, 0x00), (0x00, 0x5E, 0xD5)):
        assert (picture == (blue, green, red)).all(axis=2).sum() > 50


def test_name_of_the_file_is_plain():
    """Whatever the title holds."""
    assert Chart("A, b: 10 ms (c/d)", (), (), "").file_name() == "a-b-10-ms-c-d.png"
