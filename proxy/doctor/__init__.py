"""Looks at a robot: what is fine, what is not and what to do about it, and what cannot be seen."""
