"""Repair of walls and plans: ends that nearly meet, pieces of one line, duplicate walls."""
