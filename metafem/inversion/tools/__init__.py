"""Tools that make the caps of a surface: lists of tools, and ranges of radii or exponents."""
