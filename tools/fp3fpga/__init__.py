"""What synthesis, place and route, and builds of one configuration are made of."""
