"""The JSON schema of specifications, for completion and error marks in editors."""
