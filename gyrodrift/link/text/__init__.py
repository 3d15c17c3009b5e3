"""Lines of other people's text: their fields, the columns a person names in them, and a guess at what they hold."""
