"""Motion on ice, contact, the Kalman filter, the estimates and the simulator."""
