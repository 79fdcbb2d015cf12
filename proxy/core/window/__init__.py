"""The messages that one decision looks at."""
