"""Questions about hybrid models: do two forms agree, what contradicts what, what can never happen."""
