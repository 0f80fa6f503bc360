"""The forms of a model as frozen data that can step: Dha and Mld, and the trajectories they make."""
