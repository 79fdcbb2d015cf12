"""What can be wrong with what the core is given."""


class MalformedWireError(ValueError):
    """Something on a Sendworthy key that is no digest and no state of a known version."""
