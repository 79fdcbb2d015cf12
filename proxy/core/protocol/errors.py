"""What can be wrong with what the core is given."""


class MalformedWireError(ValueError):
    """Something on a Sendworthy key that is no digest and no state."""


class OtherVersionError(MalformedWireError):
    """A message in a `version` of the protocol that is not read here."""

    def __init__(self, version: int) -> None:
        super().__init__(f"of version {version} of what daemons tell each other")
        self.version = version
