"""The evaluation of the paper and ours: the demo, the offline optimum, a simulation, benchmarks."""
