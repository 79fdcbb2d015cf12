"""A policy of ten lines, to begin with: `README.md` shows it, and a test flies it."""


class Faded:
    """Send what fits and is worth twice as much as what its stream shows; what shows nothing is sent first."""

    def decide(self, sample, situation):  # type: ignore[no-untyped-def] # noqa: ANN001, ANN201
        """Return whether to send the sample."""
        shown = situation.shown(sample.stream)
        if shown is None:
            return situation.fits()
        return situation.fits() and sample.value(situation.now) >= 2 * shown.value(situation.now)
