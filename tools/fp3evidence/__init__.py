"""What tools/evidence.py is made of."""
