"""Filters of one state under one model, and their interaction."""
