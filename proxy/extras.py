"""What optional parts need beyond Sendworthy itself, and how to install it."""

from importlib.util import find_spec


def needs(extra: str) -> str:
    """Say that something needs an extra, and how to install it."""
    return f'needs the extra "{extra}": pip install "sendworthy[{extra}]"'


def there(package: str) -> bool:
    """Whether a package is installed."""
    return find_spec(package) is not None
