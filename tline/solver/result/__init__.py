"""Results of a run: dense output, extremes, envelopes, files."""
