"""What the notebooks call, and what builds them."""
