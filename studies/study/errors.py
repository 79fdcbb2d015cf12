"""What can be wrong with a study."""


class StudyError(Exception):
    """What was asked for cannot be studied; the message says why, and what to do."""
