"""A scene as a page on this machine: its numbers are sliders, and all that is seen follows."""
