"""Functions with delays and roots of s; the chain of a line from its load to its port."""
