"""Order and slab width for a tolerance, with error estimates."""
