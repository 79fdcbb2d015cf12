"""What `sendworthy status` says: its format, its words, its tables, and the page that explains them."""
