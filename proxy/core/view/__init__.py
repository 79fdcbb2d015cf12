"""The shared view: every stream, every robot, and how messages get from one to the other."""
