"""How stones are turned: the pictures of their caps against each other."""
