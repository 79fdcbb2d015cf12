"""What can be wrong with a replay that was asked for."""


class ReplayError(Exception):
    """The recording, or what is to be tried on it, makes no replay; the message says why, and what to do."""
