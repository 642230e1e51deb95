"""Losses inside lines."""
