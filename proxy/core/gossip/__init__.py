"""What is told to other robots, when, and within which allowance."""
