"""Clips as a decoder gives them: pictures, their times, and what is put aside of them."""
