"""One command of `datmo` a file; what is heavy is imported when the command runs."""
