"""Repair of walls and plans: ends that almost meet, collinear pieces, duplicate walls."""
