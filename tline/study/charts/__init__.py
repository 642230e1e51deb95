"""Charts of speed against accuracy, from measurements."""
