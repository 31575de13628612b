"""The systems themselves: each paper in a room of its own."""
