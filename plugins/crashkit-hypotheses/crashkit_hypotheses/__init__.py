"""The physics that a crash model may have left out."""
