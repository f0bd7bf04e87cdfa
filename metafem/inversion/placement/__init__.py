"""Assignment of heights to sites."""
