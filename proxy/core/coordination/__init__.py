"""How robots keep limits together: what counts, whose turn it is, and which part is ours."""
