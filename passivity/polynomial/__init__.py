"""Integer polynomials on the half line and in the half planes, exactly."""
