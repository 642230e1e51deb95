"""Where Newton's methods of the kernel stop."""

SPARE, CLOSE = 4e-15, 1e-10  # residuals, relative to the efforts: where to stop, and what will do if no step helps
STEPS, ULPS = 80, 4e-16  # of a scalar Newton, and the relative change at which it ends
TRIES = 40  # Newton steps for a part of the way
FAINT = 1e-9  # what a step takes for the response of waves that answer to nothing
