"""Target laws, radii and assignments to sites beyond those of the paper."""
