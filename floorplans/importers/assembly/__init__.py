"""From a draft of walls and openings to a plan: outline, openings in walls, source and start."""
