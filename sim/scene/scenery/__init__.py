"""Static scenery: plants, posts, barriers, buildings; where it stands, and how it follows the ground."""
