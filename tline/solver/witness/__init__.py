"""A second look at what a run gives out, by code that shares nothing with what made it."""
