"""Errors that make a plan unusable, and warnings about plans that can be used."""
