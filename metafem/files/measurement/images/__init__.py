"""Reading of images of contacts: grey values, size of the pixels, and forces."""
