"""What tools/gallery.py is made of."""
