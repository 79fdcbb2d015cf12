"""A profile as a flame graph: an SVG that needs nothing else.

Each box is a function, as wide as the time that was spent in it and in what it called, which stands on top of it. At
the bottom are the threads. The colour says to which stage the time belongs.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape

from proxy.profiling.profile import Profile
from proxy.profiling.stages import STAGES

WIDTH, ROW, MARGIN, HEAD = 1200.0, 17.0, 10.0, 64.0
LETTER = 6.7
"""How wide one is, at most [px]."""
FONT = 'font-family="monospace" font-size="11"'
LEAST = 0.4
"""Boxes narrower than this are left out [px]."""
COLOURS = (
    *("#E69F00", "#F0C987", "#56B4E9", "#009E73", "#5FD3B0", "#0072B2"),
    *("#D55E00", "#CC79A7", "#F0E442", "#B0B0B0", "#D8D8D8"),
)
"""One for each stage; most are of the palette of Okabe and Ito, which the colour-blind tell apart."""
_DARK = {"#009E73", "#0072B2", "#D55E00"}
"""Colours on which letters are white."""


@dataclass(slots=True)
class Box:
    """A function on top of others: what was spent in it, by stage [s], and what stands on it."""

    name: str
    stages: dict[str, float] = field(default_factory=dict)
    above: dict[str, "Box"] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """All that was spent in it [s]."""
        return sum(self.stages.values())

    @property
    def stage(self) -> str:
        """The stage for which most was spent in it."""
        return max(self.stages, key=lambda stage: self.stages[stage])

    def add(self, stage: str, seconds: float) -> None:
        """Spend more in it [s]."""
        self.stages[stage] = self.stages.get(stage, 0.0) + seconds

    @property
    def height(self) -> int:
        """How many boxes stand on each other, itself counted."""
        return 1 + max((box.height for box in self.above.values()), default=0)


def flame(profile: Profile) -> str:
    """Return the picture of a profile."""
    root = _stacked(profile)
    height = HEAD + ROW * root.height + MARGIN
    size = f'width="{WIDTH:.0f}" height="{height:.0f}"'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:.0f} {height:.0f}" {size} {FONT}>',
        f'<rect {size} fill="#ffffff"/>',
        *_head(profile),
        *_boxes(root, MARGIN, height - MARGIN - ROW, (WIDTH - 2 * MARGIN) / (root.seconds or 1.0), profile),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _stacked(profile: Profile) -> Box:
    root = Box("all")
    for branch in profile.branches:
        box = root
        box.add(branch.stage, branch.seconds)
        for name in branch.frames:
            box = box.above.setdefault(name, Box(name))
            box.add(branch.stage, branch.seconds)
    return root


def _head(profile: Profile) -> Iterator[str]:
    """Say what it is, and which colour is which stage."""
    whole, samples = sum(profile.stages.values()), profile.samples.total
    each = f", {1e3 * whole / samples:.2f} ms for each of {samples} samples" if samples else ""
    title = f"Processor time of {profile.robot}: {whole:.2f} s in {profile.seconds:.1f} s{each}"
    yield f'<text x="{MARGIN:.0f}" y="20" font-size="14">{escape(title)}</text>'
    x = MARGIN
    for stage, spent in profile.stages.items():
        if spent:
            text = f"{stage} {spent / whole:.0%}"
            yield f'<rect x="{x:.1f}" y="32" width="12" height="12" fill="{_colour(stage)}"/>'
            yield f'<text x="{x + 16:.1f}" y="42">{text}</text>'
            x += 16 + LETTER * (len(text) + 2)


def _boxes(box: Box, x: float, y: float, scale: float, profile: Profile) -> Iterator[str]:
    """Draw a box from `x`, `y` [px] on, `scale` wide for each second [px/s], and all that stands on it."""
    width, spent = box.seconds * scale, box.seconds
    if width < LEAST:
        return
    colour = _colour(box.stage)
    said = f"{box.name}: {1e3 * spent:.1f} ms, {spent / profile.seconds:.2%} of a core, {box.stage}"
    letters = int((width - 4.0) / LETTER)
    text = box.name if len(box.name) <= letters else f"{box.name[: letters - 1]}…" if letters > 3 else ""
    label = f'<text x="{x + 3:.1f}" y="{y + 12:.1f}" fill="{_ink(colour)}">{escape(text)}</text>' if text else ""
    rect = f'<rect x="{x:.2f}" y="{y:.1f}" width="{width:.2f}" height="{ROW - 1:.0f}" fill="{colour}" rx="1"/>'
    yield f"<g><title>{escape(said)}</title>{rect}{label}</g>"
    for above in sorted(box.above.values(), key=lambda each: each.name):
        yield from _boxes(above, x, y - ROW, scale, profile)
        x += above.seconds * scale


def _colour(stage: str) -> str:
    return COLOURS[STAGES.index(stage)] if stage in STAGES else COLOURS[-1]


def _ink(colour: str) -> str:
    return "#ffffff" if colour in _DARK else "#000000"
