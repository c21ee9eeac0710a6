"""Measured RSS: surveys, the tracer validated with them, and materials calibrated to them."""
