"""The files of a diagnosis; everything here only draws and writes."""
