"""Independent check of results against the equations of the scene; shares no code with the kernels."""
