"""Many clips: runs of all of them, and what they show of e and μ together."""
