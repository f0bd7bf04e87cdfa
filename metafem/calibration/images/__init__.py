"""Areas of contacts in images of the contact interface."""
