"""Measured or computed frequency responses: what they refute, and the nearest passive rational model."""
