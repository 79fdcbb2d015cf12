"""Recordings driven through the core once more: as they were, and as they would have been."""
