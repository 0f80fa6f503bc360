"""Polyhedra and the linear programs behind them; knows nothing of systems or of the language."""
