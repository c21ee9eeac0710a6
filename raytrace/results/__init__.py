"""What a trace gives: paths, radio maps, their statistics and their files."""
