"""What else comes back: mixed edges, multi-path, rain, snow and fog; one effect a file."""
