"""The project itself: its commands, extras, pages and pictures."""
