"""Beside the hits: pieces of paths fitted, hits and glides with what they tell."""
