"""The command line: what may be said on it, and how the work shows there."""
