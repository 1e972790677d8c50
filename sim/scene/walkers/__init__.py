"""People on foot: what they are after, how they keep off each other, and where they may step."""
