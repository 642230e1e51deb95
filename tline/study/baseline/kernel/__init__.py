"""The compiled loops of methods that step in time, beside which the production method stands: arrays only.

Symbols: w Thévenin waves, x states of loads, u efforts, y flows.
"""
