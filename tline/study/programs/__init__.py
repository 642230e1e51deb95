"""Other programs on the scenes of the charts, each told what it needs to know."""
