"""What tools/cluster.py is made of."""
