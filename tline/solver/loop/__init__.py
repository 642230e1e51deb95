"""The time loop: blocks, slabs with fronts, recording."""
