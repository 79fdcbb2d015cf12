"""What can be wrong with a benchmark that somebody asks for."""


class BenchError(Exception):
    """A mission cannot be read or written, or a policy cannot fly; says what and where."""
