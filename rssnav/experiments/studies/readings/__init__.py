"""Interpretations of the paper against its printed lengths, searched exactly on the empty floor."""
