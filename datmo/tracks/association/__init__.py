"""Whose box is whose: gates, joint probabilities."""
