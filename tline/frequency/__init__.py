"""A scene in the frequency domain: transfer functions, impedances, resonances and S-parameters."""
