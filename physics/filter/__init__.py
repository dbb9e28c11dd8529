"""How the filter takes a stone between two hits: its motion, place and rate by rate."""
