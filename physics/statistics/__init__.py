"""What fits share, and what many values say together."""
