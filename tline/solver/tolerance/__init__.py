"""Order and slab width for a tolerance, with estimates of what is left."""
