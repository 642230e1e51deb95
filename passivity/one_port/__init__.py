"""The exact test of rational impedances and reflections, its evidence and its margins."""
