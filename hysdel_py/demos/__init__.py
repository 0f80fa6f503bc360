"""Ready-made applications: each runs a shipped model in a loop and gathers its figures."""
