"""Energy ledger of a run: supplied, dissipated and stored energy of every element, and the residual."""
