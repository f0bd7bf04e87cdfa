"""Second methods: plain numpy and scipy, without the models that they judge, for numbers of the claims."""
