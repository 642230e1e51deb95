"""What floating point sees of a state space: never a proof."""
