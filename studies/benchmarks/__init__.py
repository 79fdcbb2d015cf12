"""How fast the planner decides and how much its decisions lose: `python -m studies.benchmarks`."""
