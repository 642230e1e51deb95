"""Drivers and receivers from IBIS files: the file's keywords, a model at a corner, its switching, a load of a scene."""
