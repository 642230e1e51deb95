"""Files of other programs, read into scenes."""
