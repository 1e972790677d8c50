"""The clusters stage."""
