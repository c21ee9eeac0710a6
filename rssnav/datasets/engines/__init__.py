"""Where plans are traced: threads of this process, or workers of a Dask cluster."""
