"""The shot again: as fitted, as predicted, and what if."""
