"""The surveillance mission of the paper (§4.3), measured on the demo: `python -m studies.surveillance`."""
