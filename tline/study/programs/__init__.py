"""Other programs on the scenes of the charts, each with an adapted input."""
