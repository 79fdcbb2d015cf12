"""Why a feature cannot be computed from a sample, in words for who wrote the spec or the application."""

from collections.abc import Mapping
from typing import Any

from utility_specs.features import Feature, Sample
from utility_specs.features.attachment import RawNumber
from utility_specs.features.document import Document
from utility_specs.suggestions import hint, quoted

LONGEST = 160
"""Characters of an error's own text."""

ABSENT = "the sample has no attachment"
"""What samples say of themselves."""

_NAMES = {"json": "JSON", "msgpack": "MessagePack"}


def reason_of(error: BaseException, feature: Feature, sample: Sample) -> str:
    """Return why `feature.measure(sample)` raised the error."""
    if _reads_nothing(feature, sample):
        return "the sample has no payload"
    if isinstance(feature, Document):
        return _of_document(error, feature, sample)
    return _words(error, sample)


def _reads_nothing(feature: Feature, sample: Sample) -> bool:
    attached = isinstance(feature, RawNumber) or (isinstance(feature, Document) and feature.attached)
    return feature.reads_payload and not attached and not sample.payload


def _of_document(error: BaseException, feature: Document, sample: Sample) -> str:
    try:
        document = feature.document(sample)
    except Exception as broken:  # noqa: BLE001 - payloads are broken in every way
        words = _words(broken, sample)
        if words == ABSENT:
            return words
        what = "attachment" if feature.attached else "payload"
        return f"the {what} is no {_NAMES[feature.format]}: {words.partition(': ')[2] or words}"
    lacking = _lacking(document, feature)
    return _words(error, sample) if lacking is None else lacking


def _lacking(document: Any, feature: Document) -> str | None:
    """Say which field on the way there is not; None where something else is wrong."""
    where, value = "the document", document
    for step in feature.reading.steps:
        match value:
            case Mapping() if step is not None and step not in value:
                return f"no field {quoted(str(step))} in {where}{hint(str(step), list(map(str, value))[:16], 'it has')}"
            case list() if isinstance(step, int) and not -len(value) <= step < len(value):
                return f"no element {step} in {where}: it has {len(value)}"
            case Mapping() if step is not None:
                where, value = quoted(str(step)), value[step]
            case list() if isinstance(step, int):
                where, value = f"element {step}", value[step]
            case _:
                return None
    return None


def _words(error: BaseException, sample: Sample) -> str:
    """Return an error's text on one line, without the key of the sample, with its kind where the text says little."""
    text, kind = " ".join(str(error).split()), type(error).__name__
    while text.startswith(outer := (f"{sample.key}: ", "FeatureError: ")):
        text = text.removeprefix(outer[0]).removeprefix(outer[1])
    said = text if kind == "FeatureError" else f"{kind}: {text}"
    said = said.removesuffix(": ").removesuffix(":")
    return said if len(said) <= LONGEST else f"{said[: LONGEST - 1]}…"
