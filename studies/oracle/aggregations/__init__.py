"""What any plan is worth, as columns and rows of a programme: one file for each aggregation."""
