"""Occupancy grids of the ROS map_server."""
