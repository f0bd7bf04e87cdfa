"""Which asperity stands at which site."""
