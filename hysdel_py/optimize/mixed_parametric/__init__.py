"""Steps of the solver of multi-parametric mixed-integer programs."""
