"""What a scan says of a track: its box, the ends of it that are real, and that it is not seen."""
