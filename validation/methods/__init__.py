"""Second methods: plain numpy, without the package's models, for the expected numbers of the claims."""
