"""One fit of the whole shot through the simulator."""
