"""What the buttons do to specs, and the way back."""

import pytest

from proxy.errors import PushError
from proxy.page.specs import checked
from proxy.page.variants import DOWNSAMPLED, PAPER, PLAIN, variant, variant_of
from tests.pages import SPECS

FILES = {"a.toml": SPECS.format(limit="1 Mbit/s"), "b.toml": "# nothing to change: scale and aggregation\n"}


@pytest.mark.parametrize("name", [PAPER, DOWNSAMPLED])
def test_a_variant_is_specs_and_leads_back(name):
    """From any to any other one, and what the files were comes back to the letter."""
    changed = variant(name, FILES)
    assert variant_of(changed) == name
    assert changed["b.toml"] == FILES["b.toml"]
    assert checked(changed)["fit"]
    assert variant(name, changed) == changed
    for other in (PAPER, DOWNSAMPLED):
        assert variant(other, changed) == variant(other, FILES)
    assert variant(PLAIN, changed) == FILES
    assert variant_of(FILES) == PLAIN


def test_variants_change_what_they_are_about():
    """The paper's aggregation; and a scale that makes no difference between samples."""
    assert '\naggregation = "most_recent"  #' in variant(PAPER, FILES)["a.toml"]
    assert '\nscale = "1"  #' in variant(DOWNSAMPLED, FILES)["a.toml"]


def test_what_goes_over_several_lines_is_left_to_the_editor():
    """With the place where it stands."""
    with pytest.raises(PushError, match=r"a\.toml:2: a scale of several lines"):
        variant(DOWNSAMPLED, {"a.toml": 'x = 1\nscale = """1 +\n1"""\n'})
