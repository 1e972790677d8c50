"""Meshes of vehicles, persons and things, each in its actor frame."""
