"""The simulator: stones that glide, hit each other and come to rest, event by event."""
