"""A public challenge: twelve target laws, a scorer that needs numpy alone, and the best results known."""
