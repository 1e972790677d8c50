"""The report of a run: what is kept while playing, the figures, the page."""
