"""Contact of a soft cap at large strain."""
