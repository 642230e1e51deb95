"""Linear scenes whose lines have a memory, by convolution quadrature."""
