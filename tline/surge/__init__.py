"""Surges in networks: operations in words, and their consequences."""
