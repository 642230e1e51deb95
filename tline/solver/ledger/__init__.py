"""The energy ledger of a run: what every element supplied, dissipated and stored, and what does not add up."""
