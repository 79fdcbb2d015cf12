"""The engine to read beside the paper; the native one grows the same trees."""
