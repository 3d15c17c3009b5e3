"""Where corrected samples go; one small file an output."""
