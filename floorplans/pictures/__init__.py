"""Plans drawn: plan view, axonometric view, and a 3-D viewer in one HTML file."""
