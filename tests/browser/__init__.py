"""Tests of pages in a browser: a package, so that they share what is closed after the last of them."""
