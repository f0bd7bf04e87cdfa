"""E* and adhesion energy from compression tests."""
