"""The methods that are compared, one small file each."""
