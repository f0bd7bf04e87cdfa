"""Second methods: plain numpy and scipy, without the package's models, for the expected numbers of the claims."""
