"""The search for floor plans in which the printed flights exist, and its score."""
