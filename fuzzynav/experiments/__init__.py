"""Our choices for what the documents leave open, and one function for each published number."""
