"""Scene as a page on this machine: its numbers are sliders, and all pictures follow."""
