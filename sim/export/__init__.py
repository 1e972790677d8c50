"""Writers of labelled clouds, one file a format."""
