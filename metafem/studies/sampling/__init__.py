"""Random numbers of the studies, and what is estimated from them."""
