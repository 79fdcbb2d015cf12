"""What features find in an image, for all that are proposed."""

from collections.abc import Mapping

from pydantic import TypeAdapter

from utility_specs.features import AnyFeatureTable, Feature, Sample
from utility_specs.features.color_fraction import HUES
from utility_specs.learning.leaves import Values

_TABLES = TypeAdapter[AnyFeatureTable](AnyFeatureTable)


class ImageFeatures:
    """The features of the images of one stream, which may remember the last one; `ros` is their type in ROS 2."""

    def __init__(self, ros: str | None) -> None:
        form = {} if ros is None else {"format": ros}
        said = {"brightness": {"kind": "brightness"}, "change": {"kind": "change"}} | {
            color: {"kind": "color_fraction", "color": color} for color in HUES
        }
        self._features: Mapping[str, Feature] = {
            name: _TABLES.validate_python(table | form).feature() for name, table in said.items()
        }
        self._first = True

    def of(self, sample: Sample) -> Values:
        """Return what an image shows, nothing of a broken one; the first one shows no change."""
        found: Values = {}
        for name, feature in self._features.items():
            try:
                found[name] = float(feature.measure(sample))
            except Exception:  # noqa: BLE001 - payloads are broken in every way
                return {}
        if self._first:
            self._first = False
            del found["change"]
        return found


def image_table(name: str, ros: str | None) -> str:
    """Return the table of a feature of images as a spec has it, without braces."""
    kind = f'kind = "{name}"' if name in {"brightness", "change"} else f'kind = "color_fraction", color = "{name}"'
    return kind if ros is None else f'{kind}, format = "{ros}"'
