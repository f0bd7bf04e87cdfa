"""Where the models fail, and whether they say so."""
