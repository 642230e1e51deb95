"""What is said to people: how places, names and values are worded, tables aligned, control characters shown, and
progress told."""
