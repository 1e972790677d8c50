"""Meshes of vehicles and persons, each in its actor frame."""
