"""The project's pages as a site: tools/site.py."""
