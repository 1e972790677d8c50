"""Scores of each stage; they know messages only."""
