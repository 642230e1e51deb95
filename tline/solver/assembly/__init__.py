"""Arrays for the kernel, from a description."""
