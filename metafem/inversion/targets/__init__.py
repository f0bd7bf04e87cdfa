"""Target friction laws."""
