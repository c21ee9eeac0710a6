"""Centre lines of walls, from whatever a file draws: areas, pairs of lines, rooms."""
