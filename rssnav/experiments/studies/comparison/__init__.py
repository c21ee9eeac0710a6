"""The comparison of oracles, learners and searchers in the same worlds."""
