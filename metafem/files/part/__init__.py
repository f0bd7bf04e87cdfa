"""The part and its mould as closed meshes."""
