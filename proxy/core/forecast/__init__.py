"""When streams generate, and what their next samples will be like."""
