"""The soft cap at large strain."""
