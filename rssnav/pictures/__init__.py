"""Figures of maps, paths and flights, in one style."""
