"""Where Newton's methods of the kernel stop."""

SPARE, CLOSE = 4e-15, 1e-10  # residuals, relative to the efforts: where to stop, and what will do if no step helps
STEPS, ULPS = 80, 4e-16  # of a scalar Newton, and the relative change at which it ends
TRIES, LEAST_STRIDE = 40, 1e-8  # Newton steps for a part of the way, and the least part
FAINT = 1e-9  # slope, for a step, of drops that have none at rest and of flows that answer to nothing
FARTHEST = 2.0  # step, in units of the largest effort
