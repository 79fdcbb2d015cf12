"""Real traffic (MODEL.md 9) in simulation: teams beside one central decider, simple policies and bounds."""
