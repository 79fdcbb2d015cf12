"""The shared view: every stream and every robot, who wants what, and what was sent."""
