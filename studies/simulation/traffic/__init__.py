"""What robots really send, in simulation: teams beside one central decider, simple policies and bounds."""
