"""Text of others as terminals may show it."""


def clean(text: str) -> str:
    """Replace what a terminal would not show but obey: keys and names are others' words."""
    return text if text.isprintable() else "".join(each if each.isprintable() else "\ufffd" for each in text)
