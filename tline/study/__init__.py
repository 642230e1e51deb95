"""Study of the methods, beside the solver: charts, baseline methods, reference solutions, other programs."""
