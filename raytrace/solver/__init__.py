"""The search for paths: setup, classes of paths, accumulation on threads, cost estimate."""
