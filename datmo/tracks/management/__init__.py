"""Births, confirmations, deaths, second finds, and the course of tracks."""
