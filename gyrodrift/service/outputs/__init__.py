"""Where corrected samples go; one small file a sink."""
