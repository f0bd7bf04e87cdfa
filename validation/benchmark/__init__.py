"""Speed, measured where anyone can repeat it: `python -m validation.benchmark`."""
