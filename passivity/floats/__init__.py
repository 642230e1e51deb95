"""Analysis of state spaces in floating point: never a proof."""
