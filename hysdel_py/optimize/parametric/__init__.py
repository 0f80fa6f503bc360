"""Multi-parametric programs: canonical form, critical regions, exploration."""
