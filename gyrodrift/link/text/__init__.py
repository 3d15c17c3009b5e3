"""Lines of foreign text: fields, columns that the user names, and a guess of the columns."""
