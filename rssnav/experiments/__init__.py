"""Experiments: the paper's figures, tables and claims, and studies beyond the paper."""
