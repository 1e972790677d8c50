"""Benchmarks: this project beside a named rival, interleaved in one process."""
