"""Samples from the app side: queued, decided, kept for others, counted."""
