"""Statistics that several fits share, and means of many values."""
