"""Exact verdicts on one-ports and multiports, with the evidence they rest on."""
