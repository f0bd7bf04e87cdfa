"""Fast products with the influence between the sites of large scenes."""
