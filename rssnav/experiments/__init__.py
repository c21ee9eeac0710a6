"""The paper, and studies beyond it."""
