"""Claims about metafem and the paper it stands on, each checked by one file."""
