"""`metafem study`: one command for each study."""
