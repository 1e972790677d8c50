"""The scan: units, casting, returns."""
