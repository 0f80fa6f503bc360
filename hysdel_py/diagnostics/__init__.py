"""What can be wrong with a source text, collected and shown with its place."""
