"""A data set in the layouts of other projects."""
