"""Times, memory and counts, each beside the largest value that is allowed."""
