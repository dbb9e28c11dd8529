"""From a clip to tracks: the only room that knows pixels."""
