"""Many tasks that differ by a seed: on any executor, with failures as records and a file to go on from."""
