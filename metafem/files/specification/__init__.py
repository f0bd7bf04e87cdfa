"""Reading of specification files into the package's own types."""
