"""Stones in pictures: sought, measured on rays, and placed on the ice."""
