"""A scene, read once, as plain data in SI."""
