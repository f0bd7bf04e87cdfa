"""The JSON schema of specifications, by which editors complete keys and mark errors."""
