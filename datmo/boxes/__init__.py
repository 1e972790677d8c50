"""The boxes stage."""
