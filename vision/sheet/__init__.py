"""The painted sheet in one picture: circles and lines found, measured and fitted."""
