"""How the messages of one stream combine: one module for each aggregation, all giving the same kind of table."""
