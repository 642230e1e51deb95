"""Flows of elements that follow from the effort across them at once."""
