"""The study of RSS readings that fluctuate; the command line calls it noise."""
