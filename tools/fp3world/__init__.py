"""What tools/world.py and tools/world_peers.py are made of."""
