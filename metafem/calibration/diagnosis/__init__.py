"""Which errors of a made part explain the difference between its measured law and the design."""
