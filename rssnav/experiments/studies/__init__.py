"""Studies beyond the paper: its open choices, noise, other methods."""
