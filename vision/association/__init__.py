"""Which sighting is which stone, from the first picture to the last."""
