"""Images of contacts as files: their grey values, the size of their pixels and the forces of each."""
