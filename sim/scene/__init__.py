"""The scene: terrain, roads, actors, traffic."""
