"""`sendworthy page`: the operator's page, in a browser."""
