"""What makes a plan unusable, and what is doubtful about one that can be used."""
