"""Claims about metafem and the paper whose method it uses, one file for each."""
