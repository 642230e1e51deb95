"""Charts of speed against accuracy: measured, never typed."""
