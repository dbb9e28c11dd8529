"""The Kalman filter of one stone between two hits, and its process model."""
