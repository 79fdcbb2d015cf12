"""All that is fuzzed byte by byte: what takes one input, and the inputs to start from."""

from collections.abc import Callable, Iterable

from tests.fuzz import config_target, payload_target, recording_target, target
from tests.fuzz.spec_target import expression_seeds, file_seeds, one_expression, one_file
from tests.utility_specs.heavy_specs import HEAVY


def _spec_seeds() -> list[bytes]:
    return [*file_seeds(), *(text.encode() for text in HEAVY.values())]


TARGETS: dict[str, tuple[Callable[[bytes], None], Callable[[], Iterable[bytes]]]] = {
    "mesh": (target.one_input, lambda: target.seeds().values()),
    "specs": (one_file, _spec_seeds),
    "expressions": (one_expression, expression_seeds),
    "configurations": (config_target.one_configuration, config_target.seeds),
    "recordings": (recording_target.one_recording, lambda: recording_target.seeds().values()),
    "payloads": (payload_target.one_payload, payload_target.payload_seeds),
    "images": (payload_target.one_image, payload_target.image_seeds),
}
