"""Wording of messages: places, names and values, aligned tables, visible control characters, and
progress."""
