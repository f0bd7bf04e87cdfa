"""What the substrate and the pedestals change in the predicted laws."""
