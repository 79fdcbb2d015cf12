"""How messages get from one robot to another: by which clock, how long they take, and how many get lost."""
