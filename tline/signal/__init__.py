"""What one measures on a scene: reflections in time, eyes, load lines."""
