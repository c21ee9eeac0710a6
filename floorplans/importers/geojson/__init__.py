"""GeoJSON and IMDF venues."""
