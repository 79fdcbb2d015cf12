"""How large a sample is: `{ kind = "size" }`."""

from dataclasses import dataclass
from typing import Literal

from utility_specs.features.feature import FeatureTable


@dataclass(frozen=True, slots=True)
class Size:
    """The length of the payload [B]."""

    default: float = 0.0

    @property
    def reads_payload(self) -> bool:
        """True: its length is the payload's."""
        return True

    def measure(self, key: str, payload: bytes) -> float:  # noqa: ARG002 - the key is for features that read it
        """Return the payload's length [B]."""
        return float(len(payload))


class SizeTable(FeatureTable):
    """`{ kind = "size" }` in a spec."""

    kind: Literal["size"]

    def feature(self) -> Size:
        """Return the feature that the table describes."""
        return Size(self.default)
