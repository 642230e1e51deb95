"""Elements that store: their flow depends on what has flowed before."""
