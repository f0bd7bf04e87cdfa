"""The pages of the examples and of the programming interface."""
