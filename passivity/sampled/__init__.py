"""Measured or computed frequency responses: refuting their passivity, and the nearest passive rational model."""
