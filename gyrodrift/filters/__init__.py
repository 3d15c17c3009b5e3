"""The filters, and the one registry by which everything else finds them."""
