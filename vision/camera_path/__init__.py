"""The camera through a clip: the house followed from picture to picture."""
