"""The building as geometry: sheets of a mesh, convex cells of its plan view, diffracting edges."""
