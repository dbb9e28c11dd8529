"""Cameras: views and lenses, fitted to marks, and the tables they come from and go to."""
