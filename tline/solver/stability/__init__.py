"""Does a scene with active loads grow, and how fast?"""
