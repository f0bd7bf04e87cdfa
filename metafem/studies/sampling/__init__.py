"""Random numbers of the studies, and estimates from them."""
