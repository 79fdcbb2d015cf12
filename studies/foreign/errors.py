"""What can be wrong with a file of others."""


class ImportFailedError(Exception):
    """A file cannot be read as traffic; the message says where, why, and what to do."""
